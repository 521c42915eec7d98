#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/batch/channel_gradient.hpp>
#include <tactnet/kernels/batch/direct_convolution.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

// The weight gradient of a convolution: for each filter, channel and tap a sum over all output pixels of all
// samples. A block of filters × taps stays in registers over a tile of output rows that fits into the
// first-level cache; a tile's sums are added across the lanes and then accumulated in double.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Output rows of a tile, for so many filters of a register block.
template <class T>
[[nodiscard]] constexpr std::size_t gradient_tile_rows(const batch_convolution& c, std::size_t filters) {
    const std::size_t row_bytes = filters * c.output.columns * lanes<T> * sizeof(T);
    return std::clamp<std::size_t>(32768 / row_bytes, 1, c.output.rows);
}
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

/// totals[f · filter_stride + tap] += the sum of the lanes of sums[f][tap].
template <std::size_t Filters, std::size_t Taps, class T>
[[gnu::always_inline]] inline void
add_across_lanes(const std::array<std::array<vector<T>, Taps>, Filters>& sums, double* totals,
                 std::size_t filter_stride) {
    constexpr std::size_t width = lanes<T>, blocks = ceil_div(Filters * Taps, width);
    alignas(vector_alignment) std::array<T, blocks * width> flat;
#pragma GCC unroll 64
    for (std::size_t block = 0; block < blocks; ++block) {
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

/// Accumulates one tile, one input channel and one kernel row: `Filters` filters × `Taps` kernel columns,
/// beginning with `first_column`.
template <batch_convolution C, std::size_t Filters, std::size_t Taps, class T>
[[gnu::flatten]] inline void
gather_tile(const T* input, const T* gradient, std::size_t begin_row, std::size_t end_row,
            std::size_t kernel_row, std::size_t first_column, double* totals, std::size_t filter_stride) {
    constexpr std::size_t width = lanes<T>, columns = C.output.columns, plane = C.output.area();
    constexpr auto top = static_cast<std::size_t>(C.top);
    std::array<std::array<vector<T>, Taps>, Filters> sums;
#pragma GCC unroll 64
    for (std::size_t f = 0; f < Filters; ++f) {
#pragma GCC unroll 64
        for (std::size_t tap = 0; tap < Taps; ++tap)
            sums[f][tap] = vector<T>(T{});
    }

    const auto left = C.left - static_cast<std::ptrdiff_t>(first_column);
    const auto position = [&](std::size_t x) {
        return static_cast<std::ptrdiff_t>(x * C.stride.columns) - left;
    };
    std::size_t begin = 0, end = columns;
    while (begin < columns && position(begin) < 0)
        ++begin;
    while (end > begin && position(end - 1) + static_cast<std::ptrdiff_t>(Taps) >
                              static_cast<std::ptrdiff_t>(C.input.columns))
        --end;
    for (std::size_t y = begin_row; y < end_row; ++y) {
        const std::size_t padded_row = y * C.stride.rows + kernel_row;
        if (padded_row < top || padded_row - top >= C.input.rows)
            continue;
        const T* from = input + (padded_row - top) * C.input.columns * width;
        const T* g = gradient + y * columns * width;
        const auto edge = [&](std::size_t x) {
            const std::ptrdiff_t p = position(x), limit = static_cast<std::ptrdiff_t>(C.input.columns);
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

/// The weight gradient by taps, summed across the lanes.
template <batch_convolution C, class T>
struct direct_gradient {
    static constexpr const char* name = "direct";
    static constexpr bool applicable = C.groups == 1;
    static constexpr std::size_t taps = std::min<std::size_t>(C.kernel.columns, 5);
    /// Filters of a register block.
    static constexpr std::size_t filters =
        std::min({std::max<std::size_t>(max_block_sums / taps, 1), std::size_t{8}, C.output.channels});
    static constexpr std::size_t tile_rows = gradient_tile_rows<T>(C, filters);
    static constexpr std::size_t half_products = direct_gradient_cost(C, ceil_div(C.output.rows, tile_rows));
    /// Pieces of work write different weights: they may run on different threads.
    static constexpr std::size_t pieces = ceil_div(C.output.channels, filters) * C.input.channels;
    static constexpr std::size_t totals = C.weights();
    static constexpr std::size_t workspace_elements = 0;

    /// sums[filter][channel][row][column] += the gradient of one lane block, for the pieces [begin, end).
    static void add(const T* input, const T* gradient, double* sums, T*, std::size_t begin, std::size_t end) {
        constexpr std::size_t width = lanes<T>, filter_size = C.input.channels * C.kernel.area();
        blocked<C.output.channels, filters>([&](auto count, std::size_t first_filter) {
            const std::size_t block = first_filter / filters * C.input.channels;
            const std::size_t first_channel = begin > block ? begin - block : 0;
            const std::size_t last_channel = end > block ? std::min(end - block, C.input.channels) : 0;
            for (std::size_t y = 0; y < C.output.rows; y += tile_rows) {
                const std::size_t end_row = std::min(y + tile_rows, C.output.rows);
                for (std::size_t channel = first_channel; channel < last_channel; ++channel)
                    for (std::size_t row = 0; row < C.kernel.rows; ++row)
                        blocked<C.kernel.columns, taps>([&](auto tap_count, std::size_t first_column) {
                            gather_tile<C, count, tap_count>(
                                input + channel * C.input.area() * width,
                                gradient + first_filter * C.output.area() * width, y, end_row, row,
                                first_column,
                                sums + first_filter * filter_size +
                                    (channel * C.kernel.rows + row) * C.kernel.columns + first_column,
                                filter_size);
                        });
            }
        });
    }
    /// gradients[filter][channel][row][column] from the sums.
    static void finish(const double* sums, T* gradients) {
        std::transform(sums, sums + totals, gradients, [](double sum) { return static_cast<T>(sum); });
    }
};

/// The weight gradient by taps, one method of the list: both have as many multiply-adds. Channels are in
/// lanes wherever they fill vectors. Tiles are compared with it before the list is.
template <batch_convolution C, class T>
using tap_gradient =
    std::conditional_t<channel_gradient<C, T>::applicable, channel_gradient<C, T>, direct_gradient<C, T>>;

}}} // namespace tactnet::kernels
