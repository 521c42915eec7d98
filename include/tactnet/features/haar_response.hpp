#pragma once

#include <tactnet/features/integral_image.hpp>

#include <cmath>
#include <concepts>
#include <cstddef>

// Responses to Haar wavelets, the gradients of SURF (Bay, Ess, Tuytelaars and Van Gool, "Speeded-Up Robust
// Features (SURF)", Computer Vision and Image Understanding 110, 2008, section 4.1).

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Horizontal and vertical response at one place.
template <class T>
struct haar_response {
    T dx, dy;
};

/// Responses to wavelets of 2 Scale × 2 Scale pixels around the corner (row, column), which may lie outside
/// of the image by `Border` − Scale: the right half less the left one, the lower half less the upper one.
/// Sums of real numbers that are no larger than their rounding count as zero, so that a constant image has
/// none.
template <std::size_t Scale, class Pixel, shape Shape, std::size_t Border>
[[nodiscard]] inline auto haar_at(const integral_image<Pixel, Shape, Border>& integral, std::ptrdiff_t row,
                                  std::ptrdiff_t column) noexcept {
    using value = typename integral_image<Pixel, Shape, Border>::value_type;
    constexpr auto s = static_cast<std::ptrdiff_t>(Scale);
    const value* upper = integral.corner_row(row - s) + column;
    const value* middle = integral.corner_row(row) + column;
    const value* lower = integral.corner_row(row + s) + column;
    const value diagonal = lower[s] - upper[-s], other = upper[s] - lower[-s];
    haar_response<value> response{diagonal - other - 2 * (lower[0] - upper[0]),
                                  diagonal + other - 2 * (middle[s] - middle[-s])};
    if constexpr (std::floating_point<value>) {
        const double limit = 8 * integral.rounding(); // eight corners, those in the middle twice
        response.dx = std::abs(response.dx) > limit ? response.dx : 0;
        response.dy = std::abs(response.dy) > limit ? response.dy : 0;
    }
    return response;
}

} // namespace TACTNET_ARCH
} // namespace tactnet
