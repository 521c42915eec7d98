#include <tactnet/kernels/random.hpp>
#include <tactnet/simulation/jpeg_storage.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdio> // before jpeglib.h, which takes FILE for granted
#include <cstdlib>
#include <jpeglib.h>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape size{28, 50}; // four blocks of rows and seven of columns, of which the last are cut
using pixels = tensor<float, size>;

/// Writes counts as JPEG in memory and reads them again, by libjpeg.
pixels by_libjpeg(const pixels& counts, int quality) {
    jpeg_error_mgr errors;
    jpeg_compress_struct writer;
    writer.err = jpeg_std_error(&errors);
    jpeg_create_compress(&writer);
    unsigned char* memory = nullptr;
    unsigned long bytes = 0;
    jpeg_mem_dest(&writer, &memory, &bytes);
    writer.image_width = size.columns;
    writer.image_height = size.rows;
    writer.input_components = 1;
    writer.in_color_space = JCS_GRAYSCALE;
    jpeg_set_defaults(&writer);
    jpeg_set_quality(&writer, quality, TRUE);
    jpeg_start_compress(&writer, TRUE);
    std::vector<unsigned char> line(size.columns);
    unsigned char* row = line.data();
    for (std::size_t y = 0; y < size.rows; ++y) {
        for (std::size_t x = 0; x < size.columns; ++x)
            line[x] = static_cast<unsigned char>(counts.data()[y * size.columns + x]);
        jpeg_write_scanlines(&writer, &row, 1);
    }
    jpeg_finish_compress(&writer);
    jpeg_destroy_compress(&writer);

    jpeg_decompress_struct reader;
    reader.err = jpeg_std_error(&errors);
    jpeg_create_decompress(&reader);
    jpeg_mem_src(&reader, memory, bytes);
    jpeg_read_header(&reader, TRUE);
    jpeg_start_decompress(&reader);
    pixels result;
    for (std::size_t y = 0; y < size.rows; ++y) {
        jpeg_read_scanlines(&reader, &row, 1);
        for (std::size_t x = 0; x < size.columns; ++x)
            result.data()[y * size.columns + x] = static_cast<float>(line[x]);
    }
    jpeg_finish_decompress(&reader);
    jpeg_destroy_decompress(&reader);
    std::free(memory);
    return result;
}

/// Blobs on nothing, as imprints are; now and then noise all over.
pixels drawn(std::uint32_t sample) {
    random_stream random(5, draw::noise, 0, sample);
    pixels counts;
    for (float& count : counts)
        count = sample % 4 == 3 ? static_cast<float>(random.below(256)) : 0;
    for (int blob = 0; blob < 4; ++blob) {
        const double y = random.uniform(0, size.rows), x = random.uniform(0, size.columns),
                     width = random.uniform(0.5, 6), peak = random.uniform(5, 400);
        for (std::size_t i = 0; i < size.size(); ++i) {
            const double dy = static_cast<double>(i / size.columns) - y,
                         dx = static_cast<double>(i % size.columns) - x;
            const double count = static_cast<double>(counts.data()[i]) +
                                 peak * std::exp(-(dx * dx + dy * dy) / (2 * width * width));
            counts.data()[i] = static_cast<float>(std::floor(std::min(count, 255.0)));
        }
    }
    return counts;
}

} // namespace

TEST_CASE("jpeg_storage: count for count what libjpeg writes and reads") {
    for (const int quality : {75, 1, 10, 49, 50, 90, 95, 100})
        for (std::uint32_t sample = 0; sample < 50; ++sample) {
            CAPTURE(quality);
            CAPTURE(sample);
            pixels counts = drawn(sample);
            const pixels expected = by_libjpeg(counts, quality);
            const simulation::jpeg_storage::bound<size> storage({.quality = quality}, {});
            storage.apply(counts.view(), {});
            std::size_t different = 0;
            for (std::size_t i = 0; i < size.size(); ++i)
                different += counts.data()[i] != expected.data()[i];
            CHECK(different == 0);
        }
}
