#pragma once

#include <tactnet/kernels/frame/winograd_tiles.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/tensor/alignment.hpp>

#include <array>
#include <cstddef>

// One frame through a convolution by tiles. winograd_tiles.hpp says what is computed, how it is cut, and
// packs the kernels.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

namespace detail {

/// Bᵀ times a column of d, or a row of d times B.
template <class Vector, std::size_t Side>
[[gnu::always_inline]] inline std::array<Vector, Side>
winograd_input_line(const std::array<Vector, Side>& d) {
    if constexpr (Side == 3)
        return {d[0] - d[1], d[1], d[1] - d[2]};
    else
        return {d[0] - d[2], d[1] + d[2], d[2] - d[1], d[1] - d[3]};
}
/// Aᵀ times a column of products, or a row of them times A.
template <class Vector, std::size_t Side>
[[gnu::always_inline]] inline std::array<Vector, 2> winograd_output_line(const std::array<Vector, Side>& m) {
    if constexpr (Side == 3)
        return {m[0] + m[1], m[1] - m[2]};
    else
        return {m[0] + m[1] + m[2], m[1] - m[2] - m[3]};
}

} // namespace detail

/// transformed[element][tile][channel] = Bᵀ d B of the input tiles [first, last); what lies outside the image
/// is zero.
template <frame_convolution C>
[[gnu::flatten, gnu::noinline]] void transform_winograd_input(const float* input, float* transformed,
                                                              std::size_t first, std::size_t last) {
    using tiles = winograd_tiles<C>;
    using wide = sized_vector<float, tiles::input_width>;
    constexpr std::size_t side = tiles::side;
    alignas(alignment) static constexpr std::array<float, tiles::input_stride> outside{};
    for (std::size_t tile = first; tile < last; ++tile) {
        const auto top = static_cast<std::ptrdiff_t>(tile / tiles::columns * 2) -
                         static_cast<std::ptrdiff_t>(C.window.top);
        const auto left = static_cast<std::ptrdiff_t>(tile % tiles::columns * 2) -
                          static_cast<std::ptrdiff_t>(C.window.left);
        std::array<const float*, tiles::elements> pixels;
        unroll<tiles::elements>([&](auto e) __attribute__((always_inline)) {
            const std::ptrdiff_t y = top + static_cast<std::ptrdiff_t>(e / side),
                                 x = left + static_cast<std::ptrdiff_t>(e % side);
            const bool inside = y >= 0 && y < static_cast<std::ptrdiff_t>(C.window.input.rows) && x >= 0 &&
                                x < static_cast<std::ptrdiff_t>(C.window.input.columns);
            pixels[e] = inside ? input + (y * static_cast<std::ptrdiff_t>(C.window.input.columns) + x) *
                                             static_cast<std::ptrdiff_t>(C.input_stride)
                               : outside.data();
        });
        float* const to = transformed + (tile - first) * tiles::input_stride;
        for (std::size_t channel = 0; channel < tiles::input_stride; channel += tiles::input_width) {
            std::array<std::array<wide, side>, side> d;
            unroll<side>([&](auto x) __attribute__((always_inline)) {
                std::array<wide, side> column;
                unroll<side>([&](auto y) __attribute__((always_inline)) {
                    column[y] = load_as<wide>(pixels[y * side + x] + channel);
                });
                column = detail::winograd_input_line(column);
                unroll<side>([&](auto y) __attribute__((always_inline)) { d[y][x] = column[y]; });
            });
            unroll<side>([&](auto y) __attribute__((always_inline)) {
                const std::array<wide, side> line = detail::winograd_input_line(d[y]);
                unroll<side>([&](auto x) __attribute__((always_inline)) {
                    store_as(to + (y * side + x) * tiles::band * tiles::input_stride + channel, line[x]);
                });
            });
        }
    }
}

/// products[tile][filter] of one element and `Tiles` tiles: a matrix product over the channels.
template <frame_convolution C, std::size_t Vectors, std::size_t Tiles>
[[gnu::flatten, gnu::noinline]] void multiply_winograd_tiles(const float* input, const float* weights,
                                                             float* products) {
    using tiles = winograd_tiles<C>;
    using wide = sized_vector<float, C.width()>;
    register_block<wide, Tiles, Vectors> sums;
#pragma GCC unroll 64
    for (std::size_t i = 0; i < Tiles * Vectors; ++i)
        sums[i / Vectors][i % Vectors] = wide(0.0f);
    for (std::size_t channel = 0; channel < tiles::channels; ++channel) {
        std::array<wide, Vectors> w;
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v)
            w[v] = load_as<wide>(weights + (channel * Vectors + v) * C.width());
#pragma GCC unroll 64
        for (std::size_t t = 0; t < Tiles; ++t) {
            const wide x(input[t * tiles::input_stride + channel]);
#pragma GCC unroll 64
            for (std::size_t v = 0; v < Vectors; ++v)
                sums[t][v] = fused_multiply_add(w[v], x, sums[t][v]);
        }
    }
#pragma GCC unroll 64
    for (std::size_t i = 0; i < Tiles * Vectors; ++i)
        store_as(products + i * C.width(), sums[i / Vectors][i % Vectors]);
}

/// Outputs of the tiles [first, last): Aᵀ m A, bias, the other term of a sum, max pool, ReLU.
template <frame_convolution C, std::size_t Vectors>
[[gnu::flatten, gnu::noinline]] void transform_winograd_output(const float* products, const float* bias,
                                                               float* output, std::size_t first,
                                                               std::size_t last) {
    using tiles = winograd_tiles<C>;
    using wide = sized_vector<float, C.width()>;
    constexpr std::size_t width = C.width(), side = tiles::side;
    for (std::size_t tile = first; tile < last; ++tile) {
        const std::size_t top = tile / tiles::columns * 2, left = tile % tiles::columns * 2;
        const bool below = top + 1 < C.rows(), right = left + 1 < C.columns();
        unroll<Vectors>([&](auto v) __attribute__((always_inline)) {
            std::array<std::array<wide, side>, 2> half;
            unroll<side>([&](auto x) __attribute__((always_inline)) {
                std::array<wide, side> column;
                unroll<side>([&](auto y) __attribute__((always_inline)) {
                    column[y] = load_as<wide>(
                        products + (((y * side + x) * tiles::band + tile - first) * Vectors + v) * width);
                });
                const std::array<wide, 2> sums = detail::winograd_output_line(column);
                half[0][x] = sums[0], half[1][x] = sums[1];
            });
            const std::array<std::array<wide, 2>, 2> y{detail::winograd_output_line(half[0]),
                                                       detail::winograd_output_line(half[1])};
            const wide start = load_as<wide>(bias + v * width);
            const auto finished = [&](wide value) {
                return C.rectified ? maximum_or_second(wide(0.0f), value) : value;
            };
            if constexpr (C.pool == extent(2)) {
                wide largest = y[0][0];
                if (right)
                    largest = maximum_or_second(y[0][1], largest);
                if (below)
                    largest = maximum_or_second(y[1][0], largest);
                if (right && below)
                    largest = maximum_or_second(y[1][1], largest);
                store_as(output + tile * C.output_stride() + v * width, finished(largest + start));
            } else {
                unroll<4>([&](auto i) __attribute__((always_inline)) {
                    if ((i / 2 == 1 && !below) || (i % 2 == 1 && !right))
                        return;
                    float* const to =
                        output + ((top + i / 2) * C.output_columns() + left + i % 2) * C.output_stride() +
                        v * width;
                    wide value = y[i / 2][i % 2] + start;
                    if constexpr (C.adds)
                        value = value + load_as<wide>(to);
                    store_as(to, finished(value));
                });
            }
        });
    }
}

/// output = the fused step, as convolve_frame. `scratch` holds winograd_tiles<C>::scratch elements.
template <frame_convolution C>
void convolve_frame_by_tiles(const float* input, const float* weights, const float* bias, float* output,
                             float* scratch) {
    static_assert(!C.adds || C.pool == extent(1), "convolve_frame_by_tiles: a sum is not pooled");
    static_assert(C.groups == 1 && C.fits_map(), "convolve_frame_by_tiles: the output does not fit its map");
    using tiles = winograd_tiles<C>;
    float* const products = scratch + tiles::transformed_input;
    blocked<tiles::count, tiles::band>([&](auto band, std::size_t first_tile) {
        transform_winograd_input<C>(input, scratch, first_tile, first_tile + band);
        blocked<C.vectors(), C.block_vectors()>([&](auto vectors, std::size_t first_vector) {
            const std::size_t first = first_vector * C.width();
            const float* w = weights + first * tiles::elements * tiles::channels;
            for (std::size_t e = 0; e < tiles::elements; ++e)
                blocked<band, tiles::block>([&](auto count, std::size_t tile) {
                    multiply_winograd_tiles<C, vectors, count>(
                        scratch + (e * tiles::band + tile) * tiles::input_stride,
                        w + e * tiles::channels * vectors * C.width(),
                        products + (e * tiles::band + tile) * vectors * C.width());
                });
            transform_winograd_output<C, vectors>(products, bias + first, output + first, first_tile,
                                                  first_tile + band);
        });
    });
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
