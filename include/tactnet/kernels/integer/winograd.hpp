#pragma once

#include <tactnet/kernels/integer/convolution.hpp>
#include <tactnet/kernels/integer/winograd_tiles.hpp>
#include <tactnet/kernels/simd/unroll.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// One frame of bytes through a convolution by tiles. winograd_tiles.hpp says what is computed, how it is cut,
// and packs the kernels.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

namespace detail {

/// Bᵀ times a column of d, or a row of d times B.
template <class Vector, std::size_t Side>
[[gnu::always_inline]] inline void integer_input_line(Vector (&d)[Side]) {
    if constexpr (Side == 3) {
        d[0] = d[0] - d[1], d[2] = d[1] - d[2];
    } else {
        const Vector sum = d[1] + d[2], difference = d[2] - d[1];
        d[0] = d[0] - d[2], d[3] = d[1] - d[3], d[1] = sum, d[2] = difference;
    }
}
/// Aᵀ times a column of products, or a row of them times A.
template <class Vector, std::size_t Side>
[[gnu::always_inline]] inline void integer_output_line(const Vector (&m)[Side], Vector& first,
                                                       Vector& second) {
    if constexpr (Side == 3)
        first = m[0] + m[1], second = m[1] - m[2];
    else
        first = m[0] + m[1] + m[2], second = m[1] - m[2] - m[3];
}

} // namespace detail

namespace detail {

/// Bᵀ d B of one tile; `pixel(row, column)` is where its channels lie, or nothing for what is outside.
template <frame_convolution C, class Pixel>
[[gnu::always_inline]] inline void transform_integer_tile(const Pixel& pixel, std::int16_t* to,
                                                          std::uint8_t padding) {
    using tiles = integer_tiles<C>;
    using words = int16_vec<tiles::input_width>;
    using bytes = uint8_vec<tiles::input_width>;
    constexpr std::size_t side = tiles::side;
    const words outside = words{} + static_cast<std::int16_t>(padding);
    for (std::size_t channel = 0; channel < tiles::channels; channel += tiles::input_width) {
        words d[side][side];
#pragma GCC unroll 64
        for (std::size_t x = 0; x < side; ++x) {
            words column[side];
#pragma GCC unroll 64
            for (std::size_t y = 0; y < side; ++y) {
                const std::uint8_t* const from = pixel(y, x);
                column[y] = from ? __builtin_convertvector(load_any<bytes>(from + channel), words) : outside;
            }
            integer_input_line(column);
#pragma GCC unroll 64
            for (std::size_t y = 0; y < side; ++y)
                d[y][x] = column[y];
        }
#pragma GCC unroll 64
        for (std::size_t y = 0; y < side; ++y) {
            integer_input_line(d[y]);
#pragma GCC unroll 64
            for (std::size_t x = 0; x < side; ++x)
                store_any(to + (y * side + x) * tiles::band * tiles::channels + channel, d[y][x]);
        }
    }
}

} // namespace detail

/// transformed[element][tile][channel] = Bᵀ d B of the input tiles [first, last); what lies outside the image
/// is `padding`.
template <frame_convolution C>
[[gnu::flatten, gnu::noinline]] void transform_integer_input(const std::uint8_t* input,
                                                             std::int16_t* transformed, std::size_t first,
                                                             std::size_t last, std::uint8_t padding) {
    using tiles = integer_tiles<C>;
    constexpr std::size_t side = tiles::side;
    constexpr shape image = C.window.input;
    for (std::size_t tile = first; tile < last; ++tile) {
        // Counted with the padding.
        const std::size_t top = tile / tiles::columns * 2, left = tile % tiles::columns * 2;
        std::int16_t* const to = transformed + (tile - first) * tiles::channels;
        if (top >= C.window.top && top + side <= C.window.top + image.rows && left >= C.window.left &&
            left + side <= C.window.left + image.columns) {
            const std::uint8_t* const corner =
                input + ((top - C.window.top) * image.columns + left - C.window.left) * C.input_stride;
            detail::transform_integer_tile<C>(
                [corner](std::size_t y, std::size_t x) __attribute__((always_inline)) {
                    return corner + (y * image.columns + x) * C.input_stride;
                },
                to, padding);
            continue;
        }
        std::array<const std::uint8_t*, tiles::elements> pixels;
#pragma GCC unroll 64
        for (std::size_t e = 0; e < tiles::elements; ++e) {
            const std::size_t y = top + e / side, x = left + e % side;
            const bool inside = y >= C.window.top && y < C.window.top + image.rows && x >= C.window.left &&
                                x < C.window.left + image.columns;
            pixels[e] =
                inside ? input + ((y - C.window.top) * image.columns + x - C.window.left) * C.input_stride
                       : nullptr;
        }
        detail::transform_integer_tile<C>(
            [&pixels](std::size_t y, std::size_t x)
                __attribute__((always_inline)) { return pixels[y * side + x]; },
            to, padding);
    }
}

/// products[tile][filter] of one element and `Tiles` tiles: a matrix product over the channels.
template <frame_convolution C, std::size_t Vectors, std::size_t Tiles>
[[gnu::flatten, gnu::noinline]] void
multiply_integer_tiles(const std::int16_t* input, const std::int16_t* weights, std::int32_t* products) {
    using tiles = integer_tiles<C>;
    using words = typename tiles::products;
    using sum = int32_vec<tiles::width>;
    register_block<sum, Tiles, Vectors> sums{};
    for (std::size_t g = 0; g < tiles::groups; ++g) {
        typename words::weights w[Vectors];
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v)
            w[v] = words::load(weights + (g * Vectors + v) * tiles::width * tiles::group);
#pragma GCC unroll 64
        for (std::size_t t = 0; t < Tiles; ++t) {
            const auto x = words::broadcast(input + t * tiles::channels + g * tiles::group);
#pragma GCC unroll 64
            for (std::size_t v = 0; v < Vectors; ++v)
                sums[t][v] = words::add(sums[t][v], w[v], x);
        }
    }
#pragma GCC unroll 64
    for (std::size_t i = 0; i < Tiles * Vectors; ++i)
        store_any(products + i * tiles::width, sums[i / Vectors][i % Vectors]);
}

/// Outputs of the tiles [first, last): Aᵀ m A, its start, the other term of a sum, max pool, rounding.
template <frame_convolution C, std::size_t Vectors, class Output>
[[gnu::flatten, gnu::noinline]] void
transform_integer_output(const std::int32_t* products, const integer_epilogue& epilogue, Output* output,
                         std::size_t first, std::size_t last) {
    using tiles = integer_tiles<C>;
    constexpr std::size_t width = tiles::width, side = tiles::side;
    using sum = int32_vec<width>;
    const auto finish = [&](Output * to, const sum& value, std::size_t v) __attribute__((always_inline)) {
        const auto factors = load_any<float_vec<width>>(epilogue.factors + v * width * sizeof(float));
        if constexpr (std::is_same_v<Output, float>)
            store_any(to, __builtin_convertvector(C.rectified ? sum(value > 0 ? value : sum{}) : value,
                                                  float_vec<width>) *
                              factors);
        else
            store_rounded<width>(to, value, factors, epilogue.range);
    };
    for (std::size_t tile = first; tile < last; ++tile) {
        const std::size_t top = tile / tiles::columns * 2, left = tile % tiles::columns * 2;
        const bool below = top + 1 < C.rows(), right = left + 1 < C.columns();
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v) {
            sum half[2][side];
#pragma GCC unroll 64
            for (std::size_t x = 0; x < side; ++x) {
                sum column[side];
#pragma GCC unroll 64
                for (std::size_t y = 0; y < side; ++y)
                    column[y] = load_any<sum>(
                        products + (((y * side + x) * tiles::band + tile - first) * Vectors + v) * width);
                detail::integer_output_line(column, half[0][x], half[1][x]);
            }
            sum y[4];
            detail::integer_output_line(half[0], y[0], y[1]);
            detail::integer_output_line(half[1], y[2], y[3]);
            const sum start = load_any<sum>(epilogue.starts + v * width * sizeof(std::int32_t));
#pragma GCC unroll 64
            for (std::size_t i = 0; i < 4; ++i)
                y[i] = (y[i] >> tiles::excess) + start;
            if constexpr (C.pool == extent2d(2)) {
                const auto larger = [](const sum& a, const sum& b) { return a > b ? a : b; };
                sum largest = y[0];
                if (right)
                    largest = larger(y[1], largest);
                if (below)
                    largest = larger(y[2], largest);
                if (right && below)
                    largest = larger(y[3], largest);
                finish(output + tile * C.output_stride() + v * width, largest, v);
            } else {
#pragma GCC unroll 64
                for (std::size_t i = 0; i < 4; ++i) {
                    if ((i / 2 == 1 && !below) || (i % 2 == 1 && !right))
                        continue;
                    Output* const to =
                        output + ((top + i / 2) * C.output_columns() + left + i % 2) * C.output_stride() +
                        v * width;
                    if constexpr (C.adds) {
                        const auto other = load_any<uint8_vec<width>>(to);
                        y[i] += __builtin_convertvector(other, sum) *
                                load_any<sum>(epilogue.added + v * width * sizeof(std::int32_t));
                    }
                    finish(to, y[i], v);
                }
            }
        }
    }
}

/// output = the fused step, as convolve_integer, of an input as it lies; what is around it is `padding`.
/// `scratch` holds integer_tiles<C>::scratch_bytes.
template <frame_convolution C, class Output>
void convolve_integer_tiles(const std::uint8_t* input, const std::int8_t* weights,
                            const integer_epilogue& epilogue, Output* output, std::uint8_t* scratch,
                            std::uint8_t padding) {
    using tiles = integer_tiles<C>;
    auto* const transformed = reinterpret_cast<std::int16_t*>(scratch);
    auto* const products = reinterpret_cast<std::int32_t*>(scratch + tiles::transformed_bytes);
    const auto* const words = reinterpret_cast<const std::int16_t*>(weights);
    blocked<tiles::count, tiles::band>([&](auto band, std::size_t first_tile) {
        transform_integer_input<C>(input, transformed, first_tile, first_tile + band, padding);
        blocked<tiles::vectors, tiles::block_vectors>([&](auto vectors, std::size_t first_vector) {
            const std::size_t first = first_vector * tiles::width;
            const std::int16_t* const of_block =
                words + first * tiles::elements * tiles::groups * tiles::group;
            for (std::size_t e = 0; e < tiles::elements; ++e)
                blocked<band, tiles::block>([&](auto count, std::size_t tile) {
                    multiply_integer_tiles<C, vectors, count>(
                        transformed + (e * tiles::band + tile) * tiles::channels,
                        of_block + e * tiles::groups * tiles::group * vectors * tiles::width,
                        products + (e * tiles::band + tile) * vectors * tiles::width);
                });
            transform_integer_output<C, vectors>(products, epilogue.from(first), output + first, first_tile,
                                                 first_tile + band);
        });
    });
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
