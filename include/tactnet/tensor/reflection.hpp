#pragma once

#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// How an image is reflected: turned upside down, left and right exchanged, both (turned by 180°), or
/// neither.
struct reflection {
    bool rows = false, columns = false;
};

/// A touch may come either way round: an object that is recognised in one of these is there in all.
inline constexpr std::array<reflection, 4> all_reflections{
    {{false, false}, {true, false}, {false, true}, {true, true}}};

/// `to` holds as many elements as `from`, and none of them.
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

/// The mean of what an image and its reflections give, in the order of all_reflections. In pairs, so that
/// each of the four gives the same bits.
[[nodiscard]] constexpr float mean_of_reflections(float upright, float rows, float columns, float both) {
    return ((upright + rows) + (columns + both)) / 4;
}

} // namespace TACTNET_ARCH
} // namespace tactnet
