#include "decode_image.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/sensors/described/npy.hpp>
#include <tactnet/sensors/recording.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <limits>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// jpeglib.h needs <cstdio> before it.
#include <jpeglib.h>
#include <png.h>

// The decoders are C and leave by longjmp only.
// NOLINTBEGIN(cert-err52-cpp)

namespace {

using tactnet::file_error;
using tactnet::grey_image;

constexpr std::size_t largest_file = std::size_t{256} << 20;

/// A decoded image before it is known to be grey: `channels` values a pixel, interleaved; 1 grey, 2 grey and
/// alpha, 3 colour, 4 colour and alpha. A value has a byte, or two with the higher one first.
struct raster {
    std::size_t rows = 0;
    std::size_t columns = 0;
    std::size_t channels = 0;
    std::size_t bytes = 1; ///< of a value
    std::vector<std::uint8_t> values;

    // True when the size is acceptable; the memory is then there.
    bool allocate(std::size_t height, std::size_t width, std::size_t components) {
        rows = height;
        columns = width;
        channels = components;
        if (rows == 0 || columns == 0 || rows > largest_image_side || columns > largest_image_side)
            return false;
        values.resize(rows * columns * channels * bytes);
        return true;
    }
};

/// What went wrong. The decoders' own errors leave by longjmp, which must not pass over C++ objects, so
/// nothing is thrown or put into words before they have returned.
struct failure {
    enum class reason { damaged, channels, size, orientation };

    reason why = reason::damaged;
    unsigned orientation = 1; ///< by EXIF; upright
    /// The decoder's own words, for a damaged file.
    std::array<char, JMSG_LENGTH_MAX> message{};

    bool set(reason what) {
        why = what;
        return false;
    }
};

/// How EXIF data, which begin with the header of a TIFF file, want the image to be shown: 1 is upright, 2 to
/// 8 are turned or mirrored. 1 where they do not say, or are damaged.
unsigned exif_orientation(std::span<const unsigned char> tiff) {
    const bool little = tiff.size() > 1 && tiff[0] == 'I' && tiff[1] == 'I';
    // A number of `bytes` bytes; 0 beyond the end.
    const auto number = [&](std::size_t at, std::size_t bytes) {
        std::size_t value = 0;
        for (std::size_t i = 0; i < bytes && at < tiff.size() && tiff.size() - at >= bytes; ++i)
            value = value << 8 | tiff[little ? at + bytes - 1 - i : at + i];
        return value;
    };
    const std::size_t directory = number(4, 4), entries = number(directory, 2);
    for (std::size_t i = 0; i < entries; ++i) {
        const std::size_t entry = directory + 2 + 12 * i, value = number(entry + 8, 2);
        if (number(entry, 2) == 0x0112 && value >= 1 && value <= 8)
            return static_cast<unsigned>(value);
    }
    return 1;
}

struct jpeg_errors {
    jpeg_error_mgr manager; // first, since libjpeg hands back a pointer to it
    std::jmp_buf leave;
    failure* result;
};

[[noreturn]] void leave_jpeg(j_common_ptr info) {
    auto* errors = reinterpret_cast<jpeg_errors*>(info->err);
    errors->manager.format_message(info, errors->result->message.data());
    std::longjmp(errors->leave, 1);
}

void on_jpeg_message(j_common_ptr info, int level) {
    // Negative levels are warnings: damage that libjpeg fills with guesses.
    if (level < 0)
        leave_jpeg(info);
}

void on_jpeg_progress(j_common_ptr info) {
    // Each scan of a progressive file costs a pass over all of it; a few bytes a scan could keep us busy for
    // hours.
    constexpr int most_scans = 200;
    if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number > most_scans) {
        auto* errors = reinterpret_cast<jpeg_errors*>(info->err);
        std::snprintf(errors->result->message.data(), errors->result->message.size(), "more than %d scans",
                      most_scans);
        std::longjmp(errors->leave, 1);
    }
}

/// Owns what libjpeg allocates, outside of the function that longjmp returns to.
struct jpeg_decoder {
    jpeg_decompress_struct info{};
    jpeg_errors errors{};
    jpeg_progress_mgr progress{};

    explicit jpeg_decoder(failure& result) {
        errors.result = &result;
        info.err = jpeg_std_error(&errors.manager);
        errors.manager.error_exit = leave_jpeg;
        errors.manager.emit_message = on_jpeg_message;
        progress.progress_monitor = on_jpeg_progress;
    }
    jpeg_decoder(const jpeg_decoder&) = delete;
    jpeg_decoder& operator=(const jpeg_decoder&) = delete;
    ~jpeg_decoder() { jpeg_destroy_decompress(&info); }
};

/// All that outlives a jump is reached through the arguments: locals that change would have no certain value.
bool decode_jpeg(jpeg_decoder& decoder, const std::vector<std::byte>& bytes, raster& image, failure& result) {
    jpeg_decompress_struct& info = decoder.info;
    if (setjmp(decoder.errors.leave) != 0)
        return false;
    jpeg_create_decompress(&info);
    info.progress = &decoder.progress;
    jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()),
                 static_cast<unsigned long>(bytes.size()));
    jpeg_save_markers(&info, JPEG_APP0 + 1, 0xFFFF);
    jpeg_read_header(&info, TRUE);
    for (const auto* marker = info.marker_list; marker != nullptr; marker = marker->next) {
        const std::span data(marker->data, marker->data_length);
        if (data.size() > 6 && std::memcmp(data.data(), "Exif\0", 6) == 0)
            result.orientation = exif_orientation(data.subspan(6));
    }
    if (result.orientation != 1)
        return result.set(failure::reason::orientation);
    image.channels = static_cast<std::size_t>(info.num_components);
    if (image.channels != 1 && image.channels != 3)
        return result.set(failure::reason::channels);
    info.out_color_space = image.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    if (!image.allocate(info.image_height, info.image_width, image.channels))
        return result.set(failure::reason::size);
    jpeg_start_decompress(&info);
    while (info.output_scanline < info.output_height) {
        JSAMPROW row = image.values.data() + info.output_scanline * image.columns * image.channels;
        jpeg_read_scanlines(&info, &row, 1);
    }
    jpeg_finish_decompress(&info);
    return true;
}

struct png_source {
    const std::vector<std::byte>* bytes;
    std::size_t position;
    failure* result;
};

[[noreturn]] void on_png_error(png_structp png, png_const_charp message) {
    auto* source = static_cast<png_source*>(png_get_error_ptr(png));
    std::snprintf(source->result->message.data(), source->result->message.size(), "%s", message);
    png_longjmp(png, 1);
}

// Warnings are about what we do not use: colour profiles, text, unknown chunks. Damage to pixels is an error.
void on_png_warning(png_structp, png_const_charp) {}

void read_png_bytes(png_structp png, png_bytep target, std::size_t size) {
    auto* source = static_cast<png_source*>(png_get_io_ptr(png));
    if (size > source->bytes->size() - source->position)
        png_error(png, "the file ends too early");
    std::memcpy(target, source->bytes->data() + source->position, size);
    source->position += size;
}

struct png_decoder {
    png_source source;
    png_structp png;
    png_infop info;
    std::vector<png_bytep> rows;

    png_decoder(const std::vector<std::byte>& bytes, failure& result)
        : source{&bytes, 0, &result},
          png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, on_png_error, on_png_warning)),
          info(png != nullptr ? png_create_info_struct(png) : nullptr) {
        if (info == nullptr) {
            png_destroy_read_struct(&png, nullptr, nullptr);
            throw std::bad_alloc();
        }
    }
    png_decoder(const png_decoder&) = delete;
    png_decoder& operator=(const png_decoder&) = delete;
    ~png_decoder() { png_destroy_read_struct(&png, &info, nullptr); }
};

/// As for JPEG, all that outlives a jump is reached through the arguments.
bool decode_png(png_decoder& decoder, raster& image, failure& result) {
    png_struct* const png = decoder.png;
    png_info* const info = decoder.info;
    if (setjmp(png_jmpbuf(png)) != 0)
        return false;
    png_set_read_fn(png, &decoder.source, read_png_bytes);
    // Checksums that do not match are errors in every chunk that pixels depend on.
    png_set_crc_action(png, PNG_CRC_ERROR_QUIT, PNG_CRC_WARN_DISCARD);
    png_read_info(png, info);
    image.bytes = png_get_bit_depth(png, info) == 16 ? 2 : 1;
    png_uint_32 exif_size = 0;
    png_bytep exif = nullptr;
    if (png_get_eXIf_1(png, info, &exif_size, &exif) != 0)
        result.orientation = exif_orientation({exif, exif_size});
    if (result.orientation != 1)
        return result.set(failure::reason::orientation);
    // Palettes, few bits and transparent colours become plain channels of 8 or 16 bits; no gamma is applied.
    png_set_expand(png);
    static_cast<void>(png_set_interlace_handling(png));
    png_read_update_info(png, info);
    if (!image.allocate(png_get_image_height(png, info), png_get_image_width(png, info),
                        png_get_channels(png, info)))
        return result.set(failure::reason::size);
    decoder.rows.resize(image.rows);
    for (std::size_t row = 0; row < image.rows; ++row)
        decoder.rows[row] = image.values.data() + row * image.columns * image.channels * image.bytes;
    png_read_image(png, decoder.rows.data());
    png_read_end(png, nullptr);
    return true;
}

grey_counts to_grey(const std::string& file, const raster& image) {
    const unsigned largest = image.bytes == 1 ? 0xFF : 0xFFFF;
    grey_counts grey{image.rows, image.columns, static_cast<float>(largest),
                     std::vector<float>(image.rows * image.columns)};
    for (std::size_t i = 0; i < grey.pixels.size(); ++i) {
        const auto value = [&](std::size_t channel) {
            const std::uint8_t* const bytes =
                image.values.data() + (i * image.channels + channel) * image.bytes;
            return image.bytes == 1 ? unsigned{bytes[0]} : unsigned{bytes[0]} << 8U | bytes[1];
        };
        const auto place = [&] {
            return "pixel in row " + std::to_string(i / image.columns) + ", column " +
                   std::to_string(i % image.columns);
        };
        if (image.channels >= 3 && (value(0) != value(1) || value(0) != value(2)))
            throw file_error(file, place(), "a grey image",
                             "red " + std::to_string(value(0)) + ", green " + std::to_string(value(1)) +
                                 ", blue " + std::to_string(value(2)));
        if (image.channels % 2 == 0 && value(image.channels - 1) != largest)
            throw file_error(file, place(), "an opaque image",
                             "alpha " + std::to_string(value(image.channels - 1)) + " of " +
                                 std::to_string(largest));
        grey.pixels[i] = static_cast<float>(value(0));
    }
    return grey;
}

[[noreturn]] void fail(const std::string& file, const std::string& kind, const raster& image,
                       const failure& result) {
    switch (result.why) {
    case failure::reason::channels:
        throw file_error(file, kind, "one grey channel, or red, green and blue",
                         std::to_string(image.channels) + " channels");
    case failure::reason::size:
        throw file_error(
            file, kind, "1 to " + std::to_string(largest_image_side) + " rows and as many columns",
            std::to_string(image.rows) + " rows and " + std::to_string(image.columns) + " columns");
    case failure::reason::orientation:
        throw file_error(file, kind, "an upright image, EXIF orientation 1",
                         "orientation " + std::to_string(result.orientation) +
                             ", by which viewers turn or mirror it");
    case failure::reason::damaged:
        break;
    }
    throw file_error(file, kind, "an intact image", tactnet::in_quotes(result.message.data(), 200));
}

bool starts_with(const std::vector<std::byte>& bytes, std::string_view magic) {
    return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

grey_counts decode_npy(const std::string& file, const std::vector<std::byte>& bytes) {
    const tactnet::recording all = tactnet::decode_all(tactnet::npy_array(), bytes);
    if (all.damage)
        throw file_error(file, "NPY data", all.damage->expected, all.damage->found);
    const bool one = all.size() == 1;
    if (!one || std::ranges::any_of(all[0].cells, [](float cell) { return !std::isfinite(cell); }))
        throw file_error(file, "NPY data", "one image, of a finite number per tactel",
                         one ? "NaN or infinity" : std::to_string(all.size()) + " frames");
    std::string_view head(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    head = head.substr(0, head.find('\n')); // which ends the header
    return {all.description.rows,
            all.description.columns,
            head.find("u1',") < head.size()   ? 255
            : head.find("u2',") < head.size() ? 65535
                                              : std::numeric_limits<float>::infinity(),
            {all[0].cells.begin(), all[0].cells.end()},
            "NPY data"};
}

} // namespace

// NOLINTEND(cert-err52-cpp)

grey_counts decode_counts(const std::filesystem::path& path) {
    const std::string file = path.string();
    const std::vector<std::byte> bytes = tactnet::read_file(path, largest_file);
    if (bytes.empty())
        throw file_error(file, "", "a JPEG or PNG image", "an empty file");
    const bool is_jpeg = starts_with(bytes, "\xFF\xD8\xFF");
    const bool is_png = starts_with(bytes, "\x89PNG\r\n\x1A\n");
    if (starts_with(bytes, tactnet::npy_array::magic))
        return decode_npy(file, bytes);
    if (!is_jpeg && !is_png)
        throw file_error(file, "", "a JPEG or PNG image",
                         "a file that begins with " +
                             tactnet::in_quotes(std::string_view(reinterpret_cast<const char*>(bytes.data()),
                                                                 std::min<std::size_t>(bytes.size(), 8))));

    raster image;
    failure result;
    bool decoded = false;
    if (is_jpeg) {
        jpeg_decoder decoder(result);
        decoded = decode_jpeg(decoder, bytes, image, result);
    } else {
        png_decoder decoder(bytes, result);
        decoded = decode_png(decoder, image, result);
    }
    if (!decoded)
        fail(file, is_jpeg ? "JPEG data" : "PNG data", image, result);
    return to_grey(file, image);
}

grey_image decode_image(const std::filesystem::path& path) {
    const grey_counts counts = decode_counts(path);
    if (counts.largest > 255)
        throw file_error(path.string(), counts.kind, "8 bits per channel",
                         counts.largest == 65535 ? "16" : "other numbers");
    grey_image image{counts.rows, counts.columns, {}};
    std::ranges::transform(counts.pixels, std::back_inserter(image.pixels),
                           [](float pixel) { return static_cast<std::uint8_t>(pixel); });
    return image;
}

void write_png(const std::filesystem::path& path, std::size_t rows, std::size_t columns,
               std::span<const std::uint8_t> pixels) {
    if (rows == 0 || columns == 0 || rows > largest_image_side || columns > largest_image_side ||
        pixels.size() != rows * columns)
        throw std::invalid_argument("write_png: " + std::to_string(rows) + " x " + std::to_string(columns) +
                                    " pixels cannot be made of " + std::to_string(pixels.size()) + " values");
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(columns);
    image.height = static_cast<png_uint_32>(rows);
    image.format = PNG_FORMAT_GRAY;
    std::vector<std::byte> bytes(PNG_IMAGE_PNG_SIZE_MAX(image));
    png_alloc_size_t size = bytes.size();
    if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr) == 0)
        throw file_error(path.string(), "", "to encode a PNG image", tactnet::in_quotes(image.message));
    bytes.resize(size);
    tactnet::write_file(path, bytes);
}
