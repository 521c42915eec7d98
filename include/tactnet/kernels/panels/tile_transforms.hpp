#pragma once

#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>
#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cstddef>

// Transforms of Winograd convolutions by square tiles, for maps that no near cache holds: y = Aᵀ [(G g Gᵀ) ∘
// (Bᵀ d B)] A, with d the input tile, g the kernel, y the outputs (simd/tile_lines.hpp).

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// to[element][channel] = Bᵀ d B of one tile, whole vectors of channels. Distances in elements.
template <std::size_t Outputs>
[[gnu::flatten, gnu::noinline]] void transform_tile(const float* from, std::size_t row_distance,
                                                    std::size_t pixel_distance, std::size_t channels,
                                                    float* to, std::size_t element_distance) {
    constexpr std::size_t side = Outputs + 2;
    using wide = vector<float>;
    for (std::size_t channel = 0; channel < channels; channel += lanes<float>) {
        detail::transform_tile_input<wide, side, side>(
            [&](std::size_t y, std::size_t x) __attribute__((always_inline)) {
                return load_as<wide>(from + y * row_distance + x * pixel_distance + channel);
            },
            [&](std::size_t y, std::size_t x, const wide& element) __attribute__((always_inline)) {
                store_as(to + (y * side + x) * element_distance + channel, element);
            });
    }
}

/// The place of the outputs of one tile, and their epilogue.
struct tile_outputs {
    float* output;
    std::size_t row_distance, pixel_distance; ///< elements
    extent2d size;                            ///< outputs that are in the image, before a pool
    bool accumulates, rectifies;
    bool pooled; ///< by a max pool of 2 × 2
};

/// Aᵀ m A + bias, the other term of a sum, max pool and ReLU, if any, of the filters [first, last).
/// `activate_tiles` applies other functions.
template <std::size_t Outputs>
[[gnu::flatten, gnu::noinline]] void transform_tile_back(const float* products, std::size_t element_distance,
                                                         const float* bias, std::size_t first,
                                                         std::size_t last, const tile_outputs& to) {
    constexpr std::size_t side = Outputs + 2, all = Outputs * Outputs;
    using wide = vector<float>;
    const auto finished = [&](const wide& value) __attribute__((always_inline)) {
        return to.rectifies ? maximum_or_second(wide(0.0f), value) : value;
    };
    for (std::size_t f = first; f < last; f += lanes<float>) {
        std::array<std::array<wide, side>, Outputs> half;
#pragma GCC unroll 64
        for (std::size_t x = 0; x < side; ++x) {
            std::array<wide, side> column;
#pragma GCC unroll 64
            for (std::size_t y = 0; y < side; ++y)
                column[y] = load_as<wide>(products + (y * side + x) * element_distance + f);
            const std::array<wide, Outputs> sums = detail::tile_output_line<Outputs>(column);
#pragma GCC unroll 64
            for (std::size_t y = 0; y < Outputs; ++y)
                half[y][x] = sums[y];
        }
        const wide start = load_as<wide>(bias + f);
        std::array<wide, all> values;
#pragma GCC unroll 64
        for (std::size_t y = 0; y < Outputs; ++y) {
            const std::array<wide, Outputs> line = detail::tile_output_line<Outputs>(half[y]);
#pragma GCC unroll 64
            for (std::size_t x = 0; x < Outputs; ++x)
                values[y * Outputs + x] = line[x] + start;
        }
        if (to.pooled) {
#pragma GCC unroll 64
            for (std::size_t i = 0; i < all / 4; ++i) {
                const std::size_t y = i / (Outputs / 2) * 2, x = i % (Outputs / 2) * 2;
                if (y >= to.size.rows || x >= to.size.columns)
                    continue;
                const bool below = y + 1 < to.size.rows, right = x + 1 < to.size.columns;
                wide largest = values[y * Outputs + x];
                if (right)
                    largest = maximum_or_second(values[y * Outputs + x + 1], largest);
                if (below)
                    largest = maximum_or_second(values[(y + 1) * Outputs + x], largest);
                if (below && right)
                    largest = maximum_or_second(values[(y + 1) * Outputs + x + 1], largest);
                store_as(to.output + y / 2 * to.row_distance + x / 2 * to.pixel_distance + f,
                         finished(largest));
            }
        } else {
#pragma GCC unroll 64
            for (std::size_t i = 0; i < all; ++i) {
                if (i / Outputs >= to.size.rows || i % Outputs >= to.size.columns)
                    continue;
                float* const place =
                    to.output + i / Outputs * to.row_distance + i % Outputs * to.pixel_distance + f;
                store_as(place, finished(to.accumulates ? values[i] + load_as<wide>(place) : values[i]));
            }
        }
    }
}

}}} // namespace tactnet::kernels
