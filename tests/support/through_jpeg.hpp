#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio> // before jpeglib.h, which takes FILE for granted
#include <cstdlib>
#include <jpeglib.h>
#include <vector>

namespace support {

/// Grey values, row by row, written as JPEG and read again by libjpeg.
inline std::vector<std::uint8_t> through_jpeg(std::vector<std::uint8_t> image, std::size_t rows,
                                              std::size_t columns, int quality) {
    jpeg_error_mgr errors;
    jpeg_compress_struct writer;
    writer.err = jpeg_std_error(&errors);
    jpeg_create_compress(&writer);
    unsigned char* memory = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&writer, &memory, &size);
    writer.image_width = static_cast<JDIMENSION>(columns);
    writer.image_height = static_cast<JDIMENSION>(rows);
    writer.input_components = 1;
    writer.in_color_space = JCS_GRAYSCALE;
    jpeg_set_defaults(&writer);
    jpeg_set_quality(&writer, quality, TRUE);
    jpeg_start_compress(&writer, TRUE);
    for (std::size_t y = 0; y < rows; ++y) {
        unsigned char* row = image.data() + y * columns;
        jpeg_write_scanlines(&writer, &row, 1);
    }
    jpeg_finish_compress(&writer);
    jpeg_destroy_compress(&writer);

    jpeg_decompress_struct reader;
    reader.err = jpeg_std_error(&errors);
    jpeg_create_decompress(&reader);
    jpeg_mem_src(&reader, memory, size);
    jpeg_read_header(&reader, TRUE);
    jpeg_start_decompress(&reader);
    for (std::size_t y = 0; y < rows; ++y) {
        unsigned char* row = image.data() + y * columns;
        jpeg_read_scanlines(&reader, &row, 1);
    }
    jpeg_finish_decompress(&reader);
    jpeg_destroy_decompress(&reader);
    std::free(memory);
    return image;
}

} // namespace support
