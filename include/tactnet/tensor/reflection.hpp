#pragma once

#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cstddef>

// Reflected images, over which a network may average its outputs.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A reflection of an image: flipped vertically, horizontally, both (a rotation by 180°) or not at all.
struct reflection {
    bool rows = false, columns = false;
};

/// The reflections of a touch: the object is the same in all of them.
inline constexpr std::array<reflection, 4> all_reflections{
    {{false, false}, {true, false}, {false, true}, {true, true}}};

/// Writes the reflected image to `to`, which must not overlap `from`.
template <class Count>
constexpr void reflect_image(const shape& image, reflection how, const Count* from, Count* to) {
    for (std::size_t channel = 0; channel < image.channels; ++channel)
        for (std::size_t row = 0; row < image.rows; ++row, to += image.columns) {
            const Count* const line =
                from + (channel * image.rows + (how.rows ? image.rows - 1 - row : row)) * image.columns;
            for (std::size_t column = 0; column < image.columns; ++column)
                to[column] = line[how.columns ? image.columns - 1 - column : column];
        }
}

/// The mean of one output over an image and its reflections, in the order of all_reflections. Added in pairs,
/// so that each of the four images gives the same bits.
[[nodiscard]] constexpr float mean_of_reflections(float upright, float rows, float columns, float both) {
    return ((upright + rows) + (columns + both)) / 4;
}

}} // namespace tactnet
