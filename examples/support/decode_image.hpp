#pragma once

// Turns JPEG, PNG and NPY files into the grey values that the networks are trained on, and grey values into
// PNG files. Strict on purpose: a value that a decoder has guessed (a damaged file), rescaled (16 bits) or
// mixed (colours) is a wrong pressure that would go unnoticed.

#include <tactnet/io/images/set.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

/// The longest side of an image that is accepted, so that a few hostile bytes cannot ask for all memory.
inline constexpr std::size_t largest_image_side = 8192;

/// Grey values as the file has them.
struct grey_counts {
    std::size_t rows = 0, columns = 0;
    float largest = 255; ///< that the file can hold: 65535 of 16 bits, infinity of deeper types of NPY
    std::vector<float> pixels{};
    const char* kind = "PNG data"; ///< of a file with more than 8 bits, in errors
};

/// Decodes a JPEG or PNG file, or one array of NPY; the content decides which, not the name. Colour is
/// accepted where red, green and blue are equal, an alpha channel where it is opaque, 1, 2 and 4 bits and
/// palettes where they stand for such greys. Throws tactnet::file_error for everything else: colours, an
/// orientation in EXIF data that viewers turn the image by, and damage, even where a decoder would go on.
grey_counts decode_counts(const std::filesystem::path& path);

/// Decodes files of 8 bits as above; throws tactnet::file_error for deeper ones too.
tactnet::grey_image decode_image(const std::filesystem::path& path);

/// Writes 8-bit grey values, row-major, as a PNG file, all or nothing.
/// Throws tactnet::file_error, and std::invalid_argument when `pixels` has not `rows * columns` values.
void write_png(const std::filesystem::path& path, std::size_t rows, std::size_t columns,
               std::span<const std::uint8_t> pixels);
