#pragma once

#include <tactnet/features/integral_image.hpp>
#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/tensor/alignment.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>

// Upright SURF descriptors on a dense grid (Bay, Ess, Tuytelaars and Van Gool, "Speeded-Up Robust Features
// (SURF)", 2008, section 4.2). A window of 20 s × 20 s pixels holds 4 × 4 subregions of 5 × 5 samples, s
// pixels apart. Each sample gives the responses dx and dy to Haar wavelets of 2 s × 2 s pixels, weighted by a
// Gaussian of 3.3 s around the centre of the window; each subregion gives Σdx, Σ|dx|, Σdy and Σ|dy|; the 64
// values are brought to unit length. Outside the image are zeros.
//
// The Gaussian is a product of one factor for the row and one for the column: responses are added up along
// columns first, for all windows beside each other at once, then along rows.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Values of one SURF descriptor, ordered [row of subregions][column of subregions][dx, |dx|, dy, |dy|].
inline constexpr std::size_t surf_values = 64;

namespace detail {

/// The factors of the Gaussian: sample k of 20 lies k − 9.5 samples from the centre.
[[nodiscard]] inline std::array<float, 20> surf_weights() {
    std::array<float, 20> weights{};
    for (std::size_t k = 0; k < weights.size(); ++k) {
        const double distance = (static_cast<double>(k) - 9.5) / 3.3;
        weights[k] = static_cast<float>(std::exp(-distance * distance / 2));
    }
    return weights;
}

/// Places of a grid along one side: as many as fit, in the middle.
struct grid_side {
    std::size_t first, step, count;

    constexpr grid_side(std::size_t size, std::size_t step_)
        : first((size - 1) % step_ / 2), step(step_), count((size - 1) / step_ + 1) {}
};

/// The descriptors of one scale.
template <shape Shape, extent2d Step, std::size_t Scale>
class surf_scale {
public:
    static constexpr grid_side rows{Shape.rows, Step.rows}, columns{Shape.columns, Step.columns};

    /// put(row of the grid, column of the grid, values): all descriptors of a row side by side.
    template <class Integral, class Put>
    void describe(const Integral& integral, const std::array<float, 20>& weights, Put&& put) noexcept {
        respond(integral);
        for (std::size_t row = 0; row < rows.count; ++row) {
            add_columns(top(row), weights);
            alignas(alignment) std::array<float, surf_values> values{};
            for (std::size_t column = 0; column < columns.count; ++column) {
                for (std::size_t part = 0; part < 16; ++part) {
                    const std::size_t first = part % 4 * 5;
                    kernels::weighted_sum<4>(bands_[part / 4].data() + (left(column) + first * Scale) * 4,
                                             4 * Scale, weights.data() + first, 5, values.data() + part * 4);
                }
                put(row, column, values);
            }
        }
    }

private:
    // From the place of a window to its first sample, so that the centre of the window is the centre of a
    // pixel for odd scales and its upper left corner for even ones: wavelets then end between pixels.
    static constexpr std::size_t radius = (19 * Scale - Scale % 2) / 2;
    // Responses that are not zero: corners less than Scale outside of the image.
    static constexpr std::size_t active_rows = Shape.rows + 2 * Scale - 1;
    static constexpr std::size_t active_columns = Shape.columns + 2 * Scale - 1;
    // Four sums a column; whole cache lines, so that the widest vectors may be used.
    static constexpr std::size_t response_stride = whole_lines(active_columns * 4);
    // Columns of zeros in front of the responses, for windows that begin outside of the image; behind them
    // too.
    static constexpr std::size_t margin = whole_lines(radius * 4) / 4;
    static constexpr std::size_t band_size =
        margin * 4 +
        std::max(response_stride,
                 whole_lines((columns.first + (columns.count - 1) * columns.step + 20 * Scale) * 4));

    /// The first sample of a window, in rows of responses: may be above them.
    [[nodiscard]] static constexpr std::ptrdiff_t top(std::size_t row) {
        return static_cast<std::ptrdiff_t>(rows.first + row * rows.step + Scale - 1) -
               static_cast<std::ptrdiff_t>(radius);
    }
    /// The same in columns of a band.
    [[nodiscard]] static constexpr std::size_t left(std::size_t column) {
        return margin + columns.first + column * columns.step + Scale - 1 - radius;
    }

    /// Brings the responses of real pixels to the middle of what single precision holds.
    template <class Integral>
    [[nodiscard]] static typename Integral::value_type factor_for(const Integral& integral) noexcept {
        if constexpr (std::floating_point<typename Integral::value_type>)
            return integral.magnitude() > 0 ? 1 / integral.magnitude() : 0;
        else
            return 1;
    }
    template <class Integral>
    void respond(const Integral& integral) noexcept {
        constexpr auto outside = static_cast<std::ptrdiff_t>(Scale) - 1;
        const auto factor = factor_for(integral);
        for (std::size_t r = 0; r < active_rows; ++r) {
            float* to = responses_.data() + r * response_stride;
            for (std::size_t c = 0; c < active_columns; ++c, to += 4) {
                const auto [dx, dy] = haar_at<Scale>(integral, static_cast<std::ptrdiff_t>(r) - outside,
                                                     static_cast<std::ptrdiff_t>(c) - outside);
                const auto x = static_cast<float>(dx * factor), y = static_cast<float>(dy * factor);
                to[0] = x, to[1] = std::abs(x), to[2] = y, to[3] = std::abs(y);
            }
        }
    }
    /// One band for each row of subregions: every column's sums over its five samples.
    void add_columns(std::ptrdiff_t first_row, const std::array<float, 20>& weights) noexcept {
        constexpr auto s = static_cast<std::ptrdiff_t>(Scale);
        for (std::size_t part = 0; part < 4; ++part) {
            std::size_t k = part * 5, end = k + 5;
            const auto row = [&](std::size_t sample) {
                return first_row + static_cast<std::ptrdiff_t>(sample) * s;
            };
            while (k < end && row(k) < 0)
                ++k;
            while (k < end && row(end - 1) >= static_cast<std::ptrdiff_t>(active_rows))
                --end;
            const std::size_t from = k < end ? static_cast<std::size_t>(row(k)) * response_stride : 0;
            kernels::weighted_sum<response_stride>(responses_.data() + from, response_stride * Scale,
                                                   weights.data() + k, end - k,
                                                   bands_[part].data() + margin * 4);
        }
    }

    alignas(alignment) std::array<float, active_rows * response_stride> responses_{};
    alignas(alignment) std::array<std::array<float, band_size>, 4> bands_{};
};

} // namespace detail

} // namespace TACTNET_ARCH
} // namespace tactnet
