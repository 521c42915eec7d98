#pragma once

// Turns JPEG and PNG files into the grey values that the networks are trained on, and grey values into PNG
// files. Strict on purpose: a pressure image has 8 bits a tactel, and a value that a decoder has guessed (a
// damaged file), rescaled (16 bits) or mixed (colours) is a wrong pressure that would go unnoticed.

#include <tactnet/io/images/set.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

/// The longest side of an image that is accepted, so that a few hostile bytes cannot ask for all memory.
inline constexpr std::size_t largest_image_side = 8192;

/// Decodes a JPEG or PNG file; the content decides which, not the name. Colour is accepted where red, green
/// and blue are equal, an alpha channel where it is opaque, 1, 2 and 4 bits and palettes where they stand for
/// such greys. Throws tactnet::file_error for everything else: 16 bits, colours, an orientation in EXIF
/// data that viewers turn the image by, and damage, even where a decoder would go on.
tactnet::grey_image decode_image(const std::filesystem::path& path);

/// Writes 8-bit grey values, row-major, as a PNG file, all or nothing.
/// Throws tactnet::file_error, and std::invalid_argument when `pixels` has not `rows * columns` values.
void write_png(const std::filesystem::path& path, std::size_t rows, std::size_t columns,
               std::span<const std::uint8_t> pixels);
