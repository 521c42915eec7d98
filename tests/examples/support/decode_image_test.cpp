#include <tactnet/io/images/folder.hpp>
#include <tactnet/io/images/set.hpp>
#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <decode_image.hpp>
#include <filesystem>
#include <functional>
#include <jpeglib.h>
#include <png.h>
#include <recording_file.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <support/files/data_folder.hpp>
#include <support/files/temporary_folder.hpp>
#include <vector>
#include <zlib.h>

using tactnet::file_error;

namespace {

using samples = std::vector<std::uint8_t>;

/// Smooth enough that a JPEG of the best quality keeps it within two grey levels.
samples gradient(std::size_t rows, std::size_t columns) {
    samples pixels;
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t column = 0; column < columns; ++column)
            pixels.push_back(static_cast<std::uint8_t>(20 + 3 * row + 2 * column));
    return pixels;
}

/// Each value `times` times in a row, as grey written in colour.
samples repeated(const samples& values, std::size_t times) {
    samples result;
    for (const std::uint8_t value : values)
        result.insert(result.end(), times, value);
    return result;
}

samples make_jpeg(std::size_t rows, std::size_t columns, J_COLOR_SPACE space, int channels,
                  const samples& values, bool progressive = false) {
    jpeg_compress_struct info{};
    jpeg_error_mgr errors{};
    info.err = jpeg_std_error(&errors);
    jpeg_create_compress(&info);
    unsigned char* target = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&info, &target, &size);
    info.image_width = static_cast<JDIMENSION>(columns);
    info.image_height = static_cast<JDIMENSION>(rows);
    info.input_components = channels;
    info.in_color_space = space;
    jpeg_set_defaults(&info);
    jpeg_set_quality(&info, 100, TRUE);
    if (progressive)
        jpeg_simple_progression(&info);
    jpeg_start_compress(&info, TRUE);
    samples copy = values;
    while (info.next_scanline < info.image_height) {
        JSAMPROW row = copy.data() + info.next_scanline * columns * static_cast<std::size_t>(channels);
        jpeg_write_scanlines(&info, &row, 1);
    }
    jpeg_finish_compress(&info);
    samples file(target, target + size);
    jpeg_destroy_compress(&info);
    std::free(target);
    return file;
}

samples make_png(std::size_t rows, std::size_t columns, int depth, int colour, const samples& packed,
                 const std::function<void(png_structp, png_infop)>& adjust = {},
                 int interlace = PNG_INTERLACE_NONE) {
    samples file;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_set_write_fn(
        png, &file,
        [](png_structp to, png_bytep data, std::size_t size) {
            auto& out = *static_cast<samples*>(png_get_io_ptr(to));
            out.insert(out.end(), data, data + size);
        },
        [](png_structp) {});
    png_set_IHDR(png, info, static_cast<png_uint_32>(columns), static_cast<png_uint_32>(rows), depth, colour,
                 interlace, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (adjust)
        adjust(png, info);
    samples copy = packed;
    std::vector<png_bytep> lines;
    for (std::size_t row = 0; row < rows; ++row)
        lines.push_back(copy.data() + row * packed.size() / rows);
    png_write_info(png, info);
    png_write_image(png, lines.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return file;
}

/// EXIF data with the orientation alone, in the order of bytes of "II" (little-endian) or "MM".
samples exif(char order, std::uint8_t orientation) {
    const auto kind = static_cast<std::uint8_t>(order);
    if (order == 'I')
        return {kind, kind, 42, 0, 8, 0,           0, 0, 1, 0, 0x12, 1, 3,
                0,    1,    0,  0, 0, orientation, 0, 0, 0, 0, 0,    0, 0};
    return {kind, kind, 0, 42, 0, 0, 0, 8, 0, 1, 1, 0x12, 0, 3, 0, 0, 0, 1, 0, orientation, 0, 0, 0, 0, 0, 0};
}

/// A JPEG file with EXIF data after its first marker.
samples with_exif(samples jpeg, const samples& data) {
    samples marker{0xFF, 0xE1, 0, static_cast<std::uint8_t>(data.size() + 8), 'E', 'x', 'i', 'f', 0, 0};
    marker.insert(marker.end(), data.begin(), data.end());
    jpeg.insert(jpeg.begin() + 2, marker.begin(), marker.end());
    return jpeg;
}

class decoder {
public:
    tactnet::grey_image operator()(const samples& file) {
        tactnet::write_file(path_, std::as_bytes(std::span(file)));
        return decode_image(path_);
    }

    /// The sentence after the file's name, or "no error".
    std::string error(const samples& file) {
        try {
            (*this)(file);
        } catch (const file_error& error) {
            CHECK(error.file() == path_.string());
            return std::string(error.what()).substr(path_.string().size() + 2);
        }
        return "no error";
    }

private:
    support::temporary_folder folder_;
    // A wrong ending on purpose: the content decides.
    std::filesystem::path path_ = folder_ / "image.txt";
};

void check_close(const tactnet::grey_image& image, std::size_t rows, std::size_t columns,
                 const samples& pixels) {
    CHECK(image.rows == rows);
    CHECK(image.columns == columns);
    REQUIRE(image.pixels.size() == pixels.size());
    for (std::size_t i = 0; i < pixels.size(); ++i)
        CHECK(std::abs(int{image.pixels[i]} - int{pixels[i]}) <= 2);
}

void check_equal(const tactnet::grey_image& image, std::size_t rows, std::size_t columns,
                 const samples& pixels) {
    CHECK(image.rows == rows);
    CHECK(image.columns == columns);
    CHECK(image.pixels == pixels);
}

} // namespace

TEST_SUITE("examples/decode_image") {
    TEST_CASE("decode_image: JPEG, grey, grey in colour, progressive") {
        decoder decode;
        const samples pixels = gradient(28, 50);
        check_close(decode(make_jpeg(28, 50, JCS_GRAYSCALE, 1, pixels)), 28, 50, pixels);
        check_close(decode(make_jpeg(28, 50, JCS_GRAYSCALE, 1, pixels, true)), 28, 50, pixels);
        check_close(decode(make_jpeg(28, 50, JCS_RGB, 3, repeated(pixels, 3))), 28, 50, pixels);
        check_close(decode(make_jpeg(1, 1, JCS_GRAYSCALE, 1, {9})), 1, 1, {9});
    }

    TEST_CASE("decode_image: JPEG that is not a grey image") {
        decoder decode;
        samples colours = repeated(gradient(8, 8), 3);
        for (std::size_t i = 0; i < colours.size(); i += 3)
            colours[i] = 200;
        CHECK(decode.error(make_jpeg(8, 8, JCS_RGB, 3, colours)).find("expected a grey image, found red ") !=
              std::string::npos);
        CHECK(decode.error(make_jpeg(8, 8, JCS_CMYK, 4, repeated(gradient(8, 8), 4))) ==
              "JPEG data: expected one grey channel, or red, green and blue, found 4 channels");
        CHECK(decode.error(make_jpeg(1, 8193, JCS_GRAYSCALE, 1, samples(8193))) ==
              "JPEG data: expected 1 to 8192 rows and as many columns, found 1 rows and 8193 columns");
    }

    TEST_CASE(
        "decode_image: an image that viewers turn is refused; upright ones and damaged EXIF data are not") {
        decoder decode;
        const samples pixels = gradient(9, 5), jpeg = make_jpeg(9, 5, JCS_GRAYSCALE, 1, pixels);
        const auto png = [&](samples data) {
            return make_png(9, 5, 8, PNG_COLOR_TYPE_GRAY, pixels, [&](png_structp to, png_infop info) {
                png_set_eXIf_1(to, info, static_cast<png_uint_32>(data.size()), data.data());
            });
        };
        for (const char order : {'I', 'M'}) {
            check_close(decode(with_exif(jpeg, exif(order, 1))), 9, 5, pixels);
            check_equal(decode(png(exif(order, 1))), 9, 5, pixels);
            for (std::uint8_t turned = 2; turned <= 8; ++turned) {
                const std::string message =
                    " data: expected an upright image, EXIF orientation 1, found orientation " +
                    std::to_string(turned) + ", by which viewers turn or mirror it";
                CHECK(decode.error(with_exif(jpeg, exif(order, turned))) == "JPEG" + message);
                CHECK(decode.error(png(exif(order, turned))) == "PNG" + message);
            }
            // No orientation, or one that does not exist.
            check_close(decode(with_exif(jpeg, exif(order, 0))), 9, 5, pixels);
            check_close(decode(with_exif(jpeg, exif(order, 9))), 9, 5, pixels);
            const samples whole = exif(order, 6);
            for (std::size_t size = 1; size <= 18; ++size)
                check_close(
                    decode(with_exif(
                        jpeg, samples(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)))),
                    9, 5, pixels);
        }
    }

    TEST_CASE("decode_image: JPEG cut short anywhere is an error") {
        decoder decode;
        for (const bool progressive : {false, true}) {
            const samples file = make_jpeg(28, 50, JCS_GRAYSCALE, 1, gradient(28, 50), progressive);
            CHECK(decode.error(file) == "no error");
            for (std::size_t size = 0; size < file.size(); ++size)
                CHECK(decode.error({file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)}) !=
                      "no error");
        }
    }

    TEST_CASE("decode_image: guesses of the JPEG decoder are errors") {
        decoder decode;
        samples file = make_jpeg(28, 50, JCS_GRAYSCALE, 1, gradient(28, 50));
        // A marker in the middle of the pixels: libjpeg would fill up the rest with grey.
        file[file.size() - 40] = 0xFF;
        file[file.size() - 39] = 0xD9;
        CHECK(
            decode.error(file).starts_with("JPEG data: expected an intact image, found 'Corrupt JPEG data"));
    }

    TEST_CASE("decode_image: any single damaged byte, of JPEG and PNG, is an image or an error") {
        decoder decode;
        for (const samples& file : {make_jpeg(9, 10, JCS_GRAYSCALE, 1, gradient(9, 10), true),
                                    make_png(9, 10, 8, PNG_COLOR_TYPE_GRAY, gradient(9, 10))})
            for (std::size_t at = 0; at < file.size(); ++at)
                for (const unsigned mask : {0x01U, 0x80U, 0xFFU}) {
                    samples damaged = file;
                    damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ mask);
                    CHECK_NOTHROW(static_cast<void>(decode.error(damaged)));
                }
    }

    TEST_CASE("decode_image: PNG, every way to write 8-bit greys gives the very values") {
        decoder decode;
        const samples pixels = gradient(28, 50);
        check_equal(decode(make_png(28, 50, 8, PNG_COLOR_TYPE_GRAY, pixels)), 28, 50, pixels);
        check_equal(decode(make_png(28, 50, 8, PNG_COLOR_TYPE_GRAY, pixels, {}, PNG_INTERLACE_ADAM7)), 28, 50,
                    pixels);
        check_equal(decode(make_png(28, 50, 8, PNG_COLOR_TYPE_RGB, repeated(pixels, 3))), 28, 50, pixels);
        const auto with_gamma = [](png_structp png, png_infop info) { png_set_gAMA(png, info, 1.0); };
        check_equal(decode(make_png(28, 50, 8, PNG_COLOR_TYPE_GRAY, pixels, with_gamma)), 28, 50, pixels);

        samples grey_alpha, colour_alpha;
        for (const std::uint8_t pixel : pixels) {
            grey_alpha.insert(grey_alpha.end(), {pixel, 255});
            colour_alpha.insert(colour_alpha.end(), {pixel, pixel, pixel, 255});
        }
        check_equal(decode(make_png(28, 50, 8, PNG_COLOR_TYPE_GRAY_ALPHA, grey_alpha)), 28, 50, pixels);
        check_equal(decode(make_png(28, 50, 8, PNG_COLOR_TYPE_RGB_ALPHA, colour_alpha)), 28, 50, pixels);

        // Few bits stand for evenly spaced greys.
        check_equal(decode(make_png(1, 8, 1, PNG_COLOR_TYPE_GRAY, {0b01100101})), 1, 8,
                    {0, 255, 255, 0, 0, 255, 0, 255});
        check_equal(decode(make_png(1, 4, 2, PNG_COLOR_TYPE_GRAY, {0b00011011})), 1, 4, {0, 85, 170, 255});
        check_equal(decode(make_png(1, 2, 4, PNG_COLOR_TYPE_GRAY, {0x3F})), 1, 2, {51, 255});

        const auto grey_palette = [](png_structp png, png_infop info) {
            const png_color colours[] = {{7, 7, 7}, {200, 200, 200}, {1, 2, 3}};
            png_set_PLTE(png, info, colours, 3);
        };
        check_equal(decode(make_png(1, 3, 8, PNG_COLOR_TYPE_PALETTE, {1, 0, 1}, grey_palette)), 1, 3,
                    {200, 7, 200});
        CHECK(decode.error(make_png(1, 3, 8, PNG_COLOR_TYPE_PALETTE, {1, 0, 2}, grey_palette)) ==
              "pixel in row 0, column 2: expected a grey image, found red 1, green 2, blue 3");
    }

    TEST_CASE("decode_counts: 16 bits as they are") {
        const support::temporary_folder folder;
        for (const int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7}) {
            const samples file = make_png(1, 3, 16, PNG_COLOR_TYPE_GRAY_ALPHA,
                                          {0, 0, 255, 255, 8, 0, 255, 255, 16, 1, 255, 255}, {}, interlace);
            tactnet::write_file(folder / "deep", std::as_bytes(std::span(file)));
            const grey_counts counts = decode_counts(folder / "deep");
            CHECK(counts.largest == 65535);
            CHECK(counts.pixels == std::vector<float>{0, 2048, 4097});
        }
    }

    TEST_CASE("decode_counts: an array of NumPy, of one frame of finite numbers") {
        decoder decode;
        const auto npy = [](const std::string& type, const std::string& shape, const std::string& cells) {
            const std::string head =
                "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
            const std::string all =
                std::string("\x93NUMPY\1\0", 8) + static_cast<char>(head.size()) + '\0' + head + cells;
            return samples(all.begin(), all.end());
        };
        check_equal(decode(npy("|u1", "1, 3", "\1\2\xFF")), 1, 3, {1, 2, 255});
        for (const auto& [file, sentence] : std::vector<std::pair<samples, std::string>>{
                 {npy("<u2", "1, 1", "\1\2"), "NPY data: expected 8 bits per channel, found 16"},
                 {npy("<i2", "1, 1", "\1\2"), "NPY data: expected 8 bits per channel, found other numbers"},
                 {npy("|u1", "2, 1, 1", "\1\2"),
                  "NPY data: expected one image, of a finite number per tactel, found 2 frames"},
                 {npy("<f4", "1, 1", std::string("\0\0\xC0\x7F", 4)),
                  "NPY data: expected one image, of a finite number per tactel, found NaN or infinity"},
                 {npy("|u1", "1, 2", "\1"), "NPY data: expected 2 bytes of a frame, found 1 of them"}})
            CHECK(decode.error(file) == sentence);
    }

    TEST_CASE("read_recording_file: archives of NumPy, images, other bytes; damage") {
        // A plain array of one dimension, which is left out, and a deflated one of two frames.
        constexpr std::string_view hexadecimal =
            "504b030414000000000000002100116268854500000045000000010000006c934e554d505901003a007b27646573"
            "6372273a20277c7531272c2027666f727472616e5f6f72646572273a2046616c73652c20277368617065273a2028"
            "312c292c207d0a00504b030414000000080000002100a14abaff4a0000004d00000001000000619bec17ea1b10c9"
            "c860cf50ad9e925a9c5ca46ea5a05e536aa8aea3a09e965f54529498179f5f94920a12774bcc294e058a17672416"
            "a402f91a463a0a863a0a469a3a0ab55c8c4ccc2c00504b0102140314000000000000002100116268854500000045"
            "0000000100000000000000000000008001000000006c504b0102140314000000080000002100a14abaff4a000000"
            "4d00000001000000000000000000000080016400000061504b050600000000020002005e000000cd0000000000";
        std::string archive;
        for (std::size_t i = 0; i < hexadecimal.size(); i += 2)
            archive += static_cast<char>(std::stoi(std::string(hexadecimal.substr(i, 2)), nullptr, 16));
        const support::temporary_folder folder;
        const auto read = [&](const std::string& bytes) {
            tactnet::write_file(folder / "file", bytes);
            const auto found = read_recording_file(folder / "file");
            return std::string(reinterpret_cast<const char*>(found.data()), found.size());
        };
        const std::string array = read(archive);
        CHECK(array.starts_with("\x93NUMPY"));
        CHECK(array.ends_with("(2, 1, 2), }\n\1\2\3\4"));
        CHECK(read("any bytes") == "any bytes");
        const samples image = make_png(2, 1, 16, PNG_COLOR_TYPE_GRAY, {1, 2, 3, 4});
        CHECK(read({image.begin(), image.end()}) == "P5 1 2 65535\n\1\2\3\4");
        std::size_t refused = 0;
        const auto refuses = [&](const std::string& bytes) {
            try {
                const bool same = read(bytes) == array || !bytes.starts_with("PK\3\4");
                CHECK(same);
            } catch (const file_error& error) {
                refused += !error.expected().empty() && !error.found().empty();
            }
        };
        for (std::size_t at = 0; at < archive.size(); ++at) {
            refuses(archive.substr(0, at));
            for (const int flip : {1, 0x55, 0xFF}) {
                std::string damaged = archive;
                damaged[at] = static_cast<char>(damaged[at] ^ flip);
                refuses(damaged);
            }
        }
        CHECK(refused > 2 * archive.size());
        // Few bytes that become many: all entries together have a limit, and deflate has one.
        CHECK(read(archive) == array);
        CHECK_NOTHROW(static_cast<void>(read_recording_file(folder / "file", 69 + 77)));
        CHECK_THROWS_WITH_AS(static_cast<void>(read_recording_file(folder / "file", 69 + 76)),
                             doctest::Contains("entry 'a': expected at most 76 bytes, found 77"), file_error);
        std::string deeper = archive; // plain bytes, with four dimensions in the place of one
        deeper.replace(deeper.find("(1,), }\n"), 8, "(1,1,1,1");
        const std::size_t entry = deeper.find("PK\1\2");
        const std::string data = deeper.substr(31, 69);
        const auto sum =
            crc32(0, reinterpret_cast<const Bytef*>(data.data()), static_cast<uInt>(data.size()));
        for (unsigned byte = 0; byte < 4; ++byte)
            deeper[entry + 16 + byte] = static_cast<char>(sum >> (8 * byte) & 0xFFU);
        CHECK_THROWS_WITH_AS(
            static_cast<void>(read(deeper)),
            doctest::Contains("entry 'l': expected an array of rows x columns, or frames x rows "
                              "x columns, found 4 dimensions"),
            file_error);
        archive[archive.rfind("PK\1\2") + 26] = 2;
        CHECK_THROWS_WITH_AS(static_cast<void>(read(archive)), doctest::Contains("found 131149 for 74"),
                             file_error);
    }

    TEST_CASE("decode_image: PNG that is not an opaque image of 8-bit greys") {
        decoder decode;
        for (const int colour : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_RGB})
            CHECK(decode.error(make_png(2, 2, 16, colour, samples(colour == PNG_COLOR_TYPE_RGB ? 24 : 8))) ==
                  "PNG data: expected 8 bits per channel, found 16");
        CHECK(decode.error(make_png(1, 1, 16, PNG_COLOR_TYPE_RGB, {1, 2, 1, 2, 1, 3})) ==
              "pixel in row 0, column 0: expected a grey image, found red 258, green 258, blue 259");
        CHECK(decode.error(make_png(2, 2, 8, PNG_COLOR_TYPE_RGB, {1, 1, 1, 2, 2, 2, 3, 4, 3, 5, 5, 5})) ==
              "pixel in row 1, column 0: expected a grey image, found red 3, green 4, blue 3");
        CHECK(decode.error(make_png(1, 2, 8, PNG_COLOR_TYPE_GRAY_ALPHA, {9, 255, 9, 254})) ==
              "pixel in row 0, column 1: expected an opaque image, found alpha 254 of 255");
        const auto transparent = [](png_structp png, png_infop info) {
            png_color_16 colour{};
            colour.gray = 9;
            png_set_tRNS(png, info, nullptr, 0, &colour);
        };
        CHECK(decode.error(make_png(1, 2, 8, PNG_COLOR_TYPE_GRAY, {8, 8}, transparent)) == "no error");
        CHECK(decode.error(make_png(1, 2, 8, PNG_COLOR_TYPE_GRAY, {8, 9}, transparent)) ==
              "pixel in row 0, column 1: expected an opaque image, found alpha 0 of 255");
        CHECK(decode.error(make_png(8193, 1, 8, PNG_COLOR_TYPE_GRAY, samples(8193))) ==
              "PNG data: expected 1 to 8192 rows and as many columns, found 8193 rows and 1 columns");
    }

    TEST_CASE("decode_image: PNG cut short or changed anywhere is an error") {
        decoder decode;
        const samples file = make_png(28, 50, 8, PNG_COLOR_TYPE_GRAY, gradient(28, 50));
        CHECK(decode.error(file) == "no error");
        for (std::size_t at = 0; at < file.size(); ++at) {
            CAPTURE(at);
            CHECK(decode.error({file.begin(), file.begin() + static_cast<std::ptrdiff_t>(at)}) != "no error");
            samples damaged = file;
            damaged[at] = static_cast<std::uint8_t>(damaged[at] ^ 0x10);
            CHECK(decode.error(damaged) != "no error");
        }
        CHECK(decode.error({file.begin(), file.end() - 1}) ==
              "PNG data: expected an intact image, found 'the file ends too early'");
    }

    TEST_CASE("decode_image: what is no image") {
        decoder decode;
        CHECK(decode.error({}) == "expected a JPEG or PNG image, found an empty file");
        CHECK(decode.error({'G', 'I', 'F', '8', '9', 'a', 1, 2, 3}) ==
              "expected a JPEG or PNG image, found a file that begins with 'GIF89a\\x01\\x02'");
        CHECK(decode.error({0xFF}) == "expected a JPEG or PNG image, found a file that begins with '\\xff'");
        const support::temporary_folder folder;
        CHECK_THROWS_AS(decode_image(folder.path()), file_error);
        CHECK_THROWS_AS(decode_image(folder / "missing.png"), file_error);
    }

    TEST_CASE("write_png: grey values are read again") {
        const support::temporary_folder folder;
        samples all(256);
        for (std::size_t i = 0; i < all.size(); ++i)
            all[i] = static_cast<std::uint8_t>(i);
        write_png(folder / "all.png", 8, 32, all);
        check_equal(decode_image(folder / "all.png"), 8, 32, all);
        CHECK_THROWS_AS(write_png(folder / "x.png", 8, 31, all), std::invalid_argument);
        CHECK_THROWS_AS(write_png(folder / "x.png", 0, 0, {}), std::invalid_argument);
        CHECK_THROWS_AS(write_png(folder / "missing" / "x.png", 8, 32, all), file_error);
        CHECK_FALSE(std::filesystem::exists(folder / "x.png"));
    }

    TEST_CASE("decode_image: the real recordings" * doctest::test_suite("data")) {
        const auto root = support::find_data("tactile_images");
        if (!root)
            return;
        const auto set = tactnet::load_images(tactnet::list_image_folder(*root), 28, 50, decode_image);
        CHECK(set.size() == 1100);
        CHECK(set.pixels.size() == std::size_t{1100} * 28 * 50);
        // Some tactels are pressed and some are not.
        CHECK(std::ranges::count(set.pixels, 0) > 100'000);
        CHECK(std::ranges::count_if(set.pixels, [](std::uint8_t value) { return value > 100; }) > 10'000);
    }
}
