#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/batch/winograd/tile_grid.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// Converts and stores the first `count` lanes.
template <class T>
inline void put_lanes(T* to, const vector<double>& values, std::size_t count) {
    if constexpr (std::is_same_v<T, float>)
        if (count == lanes<double>)
            return narrow(to, values);
    alignas(alignment) std::array<double, lanes<double>> flat;
    store(flat.data(), values);
    for (std::size_t lane = 0; lane < count; ++lane)
        to[lane] = static_cast<T>(flat[lane]);
}

/// Transforms the kernels, G g Gᵀ, and packs blocks of output channels, each [element][input channel][channel
/// of the block]. Computes in double, several output channels at once: training packs anew after each step.
template <batch_convolution C, extent2d Outputs, class Weight, class T>
[[gnu::flatten]] void pack_tile_weights(const Weight& weight, T* packed) {
    constexpr extent2d side = tile_grid::of(C, Outputs).side;
    constexpr std::size_t kernel = C.kernel.rows, taps = kernel * kernel, width = lanes<double>,
                          block = round_up(block_channels, width);
    // Input channels that are collected before the first is read: a vector load cannot forward from several
    // narrow stores that are still in flight.
    constexpr std::size_t inputs = 8;
    alignas(alignment) std::array<std::array<std::array<double, block>, taps>, inputs> collected{};
    for (std::size_t first = 0; first < C.output.channels; first += block_channels) {
        const std::size_t count = std::min(block_channels, C.output.channels - first),
                          distance = odd_lines<T>(C.input.channels * count);
        for (std::size_t input = 0; input < C.input.channels; ++input) {
            if (input % inputs == 0)
                for (std::size_t i = 0; i < std::min(inputs, C.input.channels - input); ++i)
                    for (std::size_t channel = 0; channel < count; ++channel)
                        for (std::size_t tap = 0; tap < taps; ++tap)
                            collected[i][tap][channel] = static_cast<double>(
                                weight(first + channel, input + i, tap / kernel, tap % kernel));
            for (std::size_t lane = 0; lane < count; lane += width) {
                std::array<std::array<vector<double>, kernel>, side.rows> half;
#pragma GCC unroll 64
                for (std::size_t column = 0; column < kernel; ++column) {
                    std::array<vector<double>, kernel> taps_of_row;
#pragma GCC unroll 64
                    for (std::size_t row = 0; row < kernel; ++row)
                        taps_of_row[row] =
                            load(collected[input % inputs][row * kernel + column].data() + lane);
                    const auto line = detail::tile_kernel_line<side.rows>(taps_of_row);
#pragma GCC unroll 64
                    for (std::size_t row = 0; row < side.rows; ++row)
                        half[row][column] = line[row];
                }
                T* to = packed + input * count + lane;
                const std::size_t left = std::min(count - lane, width);
#pragma GCC unroll 64
                for (std::size_t row = 0; row < side.rows; ++row) {
                    const auto line = detail::tile_kernel_line<side.columns>(half[row]);
#pragma GCC unroll 64
                    for (std::size_t column = 0; column < side.columns; ++column, to += distance)
                        put_lanes(to, line[column], left);
                }
            }
        }
        packed += side.area() * distance;
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
