#pragma once

#include <tactnet/kernels/batch/convolution.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// The gradient of a convolution with respect to its weights: for every filter, channel and tap a sum over all
// output pixels of all samples. A block of filters × taps stays in registers over a tile of output rows small
// enough for the first-level cache; a tile's sums are added across lanes and then gathered in double.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// Register and cache blocking of a weight gradient.
template <sliding_window W, std::size_t Filters, class T>
struct weight_gradient_plan {
    static constexpr std::size_t taps = std::min<std::size_t>(W.kernel.columns, 5);
    static constexpr std::size_t budget = vector_registers == 32 ? 24 : 12;
    static constexpr std::size_t filters =
        std::min({std::max<std::size_t>(budget / taps, 1), std::size_t{8}, Filters});
    static constexpr std::size_t row_bytes = filters * W.output_columns() * lanes<T> * sizeof(T);
    static constexpr std::size_t tile_rows = std::clamp<std::size_t>(32768 / row_bytes, 1, W.output_rows());
    /// Pieces of work that write different weights, and so may run on different threads.
    static constexpr std::size_t pieces = (Filters + filters - 1) / filters * W.input.channels;
};

/// Adds the products of one output pixel. Taps outside of [first_tap, last_tap) lie on padding.
template <std::size_t Filters, std::size_t Taps, std::size_t Plane, bool Interior, class T>
[[gnu::always_inline]] inline void add_products(std::array<std::array<vector<T>, Taps>, Filters>& sums,
                                                const T* gradient, const T* input, std::size_t first_tap,
                                                std::size_t last_tap) {
    std::array<vector<T>, Filters> g;
#pragma GCC unroll 64
    for (std::size_t f = 0; f < Filters; ++f)
        g[f] = load(gradient + f * Plane * lanes<T>);
#pragma GCC unroll 64
    for (std::size_t tap = 0; tap < Taps; ++tap)
        if (Interior || (tap >= first_tap && tap < last_tap)) {
            const vector<T> x = load(input + static_cast<std::ptrdiff_t>(tap * lanes<T>));
#pragma GCC unroll 64
            for (std::size_t f = 0; f < Filters; ++f)
                sums[f][tap] = multiply_add(g[f], x, sums[f][tap]);
        }
}

/// totals[f][k] of the first `Filters` filters from `totals` on += the sums across lanes.
template <std::size_t Filters, std::size_t Taps, class T>
[[gnu::always_inline]] inline void
add_across_lanes(const std::array<std::array<vector<T>, Taps>, Filters>& sums, double* totals,
                 std::size_t filter_stride) {
    constexpr std::size_t width = lanes<T>;
    alignas(alignment) std::array<T, (Filters * Taps + width - 1) / width * width> flat;
#pragma GCC unroll 64
    for (std::size_t block = 0; block < (Filters * Taps + width - 1) / width; ++block) {
        std::array<vector<T>, width> rows;
#pragma GCC unroll 64
        for (std::size_t r = 0; r < width; ++r) {
            const std::size_t i = block * width + r;
            rows[r] = i < Filters * Taps ? sums[i / Taps % Filters][i % Taps] : vector<T>(T{});
        }
        store(flat.data() + block * width, sums_across_lanes<T>(rows));
    }
    for (std::size_t f = 0; f < Filters; ++f)
        for (std::size_t tap = 0; tap < Taps; ++tap)
            totals[f * filter_stride + tap] += static_cast<double>(flat[f * Taps + tap]);
}

/// One tile, one input channel, one kernel row: `Filters` filters × `Taps` kernel columns from `first_column`
/// on.
template <sliding_window W, std::size_t Filters, std::size_t Taps, class T>
[[gnu::flatten]] inline void
gather_tile(const T* input, const T* gradient, std::size_t begin_row, std::size_t end_row,
            std::size_t kernel_row, std::size_t first_column, double* totals, std::size_t filter_stride) {
    constexpr std::size_t width = lanes<T>, columns = W.output_columns(), plane = W.output_rows() * columns;
    std::array<std::array<vector<T>, Taps>, Filters> sums;
#pragma GCC unroll 64
    for (std::size_t f = 0; f < Filters; ++f) {
#pragma GCC unroll 64
        for (std::size_t tap = 0; tap < Taps; ++tap)
            sums[f][tap] = vector<T>(T{});
    }

    const auto left = static_cast<std::ptrdiff_t>(W.left) - static_cast<std::ptrdiff_t>(first_column);
    const auto position = [&](std::size_t x) {
        return static_cast<std::ptrdiff_t>(x * W.stride.columns) - left;
    };
    std::size_t begin = 0, end = columns;
    while (begin < columns && position(begin) < 0)
        ++begin;
    while (end > begin && position(end - 1) + static_cast<std::ptrdiff_t>(Taps) >
                              static_cast<std::ptrdiff_t>(W.input.columns))
        --end;
    for (std::size_t y = begin_row; y < end_row; ++y) {
        const std::size_t padded_row = y * W.stride.rows + kernel_row;
        if (padded_row < W.top || padded_row - W.top >= W.input.rows)
            continue;
        const T* from = input + (padded_row - W.top) * W.input.columns * width;
        const T* g = gradient + y * columns * width;
        const auto edge = [&](std::size_t x) {
            const std::ptrdiff_t p = position(x), limit = static_cast<std::ptrdiff_t>(W.input.columns);
            const auto first = std::clamp<std::ptrdiff_t>(-p, 0, Taps),
                       last = std::clamp<std::ptrdiff_t>(limit - p, 0, Taps);
            add_products<Filters, Taps, plane, false>(
                sums, g + x * width, from + p * static_cast<std::ptrdiff_t>(width),
                static_cast<std::size_t>(first), static_cast<std::size_t>(last));
        };
        for (std::size_t x = 0; x < begin; ++x)
            edge(x);
        for (std::size_t x = begin; x < end; ++x)
            add_products<Filters, Taps, plane, true>(
                sums, g + x * width, from + position(x) * static_cast<std::ptrdiff_t>(width), 0, Taps);
        for (std::size_t x = end; x < columns; ++x)
            edge(x);
    }
    add_across_lanes<Filters, Taps>(sums, totals, filter_stride);
}

/// totals[filter][channel][row][column] += the weight gradient of one group, for the pieces [begin, end) of
/// weight_gradient_plan::pieces.
template <sliding_window W, std::size_t Filters, class T>
void add_weight_gradient(const T* input, const T* gradient, double* totals, std::size_t begin,
                         std::size_t end) {
    using plan = weight_gradient_plan<W, Filters, T>;
    constexpr std::size_t width = lanes<T>, plane = W.output_rows() * W.output_columns();
    constexpr std::size_t filter_size = W.input.channels * W.kernel.area();
    blocked<Filters, plan::filters>([&](auto filters, std::size_t first_filter) {
        const std::size_t block = first_filter / plan::filters * W.input.channels;
        const std::size_t first_channel = begin > block ? begin - block : 0;
        const std::size_t last_channel = end > block ? std::min(end - block, W.input.channels) : 0;
        for (std::size_t y = 0; y < W.output_rows(); y += plan::tile_rows) {
            const std::size_t end_row = std::min(y + plan::tile_rows, W.output_rows());
            for (std::size_t channel = first_channel; channel < last_channel; ++channel)
                for (std::size_t row = 0; row < W.kernel.rows; ++row)
                    blocked<W.kernel.columns, plan::taps>([&](auto taps, std::size_t first_column) {
                        gather_tile<W, filters, taps>(
                            input + channel * W.input.area() * width, gradient + first_filter * plane * width,
                            y, end_row, row, first_column,
                            totals + first_filter * filter_size +
                                (channel * W.kernel.rows + row) * W.kernel.columns + first_column,
                            filter_size);
                    });
        }
    });
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
