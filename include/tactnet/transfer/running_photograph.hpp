#pragma once

#include <tactnet/image/dynamic_resize.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/transfer/photograph.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

// A photograph of an image whose size is known only when running, for programs that compile a trunk once for
// images of all sizes.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// As the to_photograph of photograph.hpp, with the resize in double precision: where that one rounds to
/// counts, the two may differ by one count here and there. `to` is [channel][row][column], of three channels.
/// Throws std::invalid_argument for an empty image, and unless both are as long as their sizes say.
inline void to_photograph(std::span<const std::uint8_t> image, extent2d grey, const photograph_form& form,
                          extent2d photograph, std::span<float> to) {
    const std::size_t area = photograph.area();
    if (to.size() != 3 * area)
        throw std::invalid_argument("to_photograph: expected room for " + std::to_string(3 * area) +
                                    " numbers, found " + std::to_string(to.size()));
    const auto first = to.first(area);
    if (form.pixel == resized_pixel::count) {
        const auto counts =
            resize_bicubic(image, grey.rows, grey.columns, photograph.rows, photograph.columns);
        std::copy(counts.begin(), counts.end(), first.begin());
    } else {
        const std::vector<float> numbers(image.begin(), image.end());
        const auto resized = resize_bicubic(std::span<const float>(numbers), grey.rows, grey.columns,
                                            photograph.rows, photograph.columns);
        std::copy(resized.begin(), resized.end(), first.begin());
    }
    detail::spread_first_channel(to, form.normalise);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
