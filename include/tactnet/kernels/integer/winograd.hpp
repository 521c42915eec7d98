#pragma once

#include <tactnet/kernels/integer/byte_products.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/integer/winograd_tiles.hpp>
#include <tactnet/kernels/simd/compiler_vector.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>
#include <tactnet/kernels/simd/unroll.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// Winograd convolution of one frame of bytes in integers. winograd_tiles.hpp has the tiles and packs the
// kernels.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// transformed[element][tile][channel] = Bᵀ d B of the input tiles [first, last); pixels outside the image
/// are `padding`.
template <frame_convolution C>
[[gnu::flatten, gnu::noinline]] void transform_integer_input(const std::uint8_t* input,
                                                             std::int16_t* transformed, std::size_t first,
                                                             std::size_t last, std::uint8_t padding) {
    using tiles = integer_tiles<C>;
    using words = int16_vec<tiles::input_width>;
    using bytes = uint8_vec<tiles::input_width>;
    constexpr std::size_t side = tiles::side;
    constexpr shape image = C.window.input;
    const words outside = words{} + static_cast<std::int16_t>(padding);
    for (std::size_t tile = first; tile < last; ++tile) {
        // Counted with the padding.
        const std::size_t top = tile / tiles::columns * 2, left = tile % tiles::columns * 2;
        std::int16_t* const to = transformed + (tile - first) * tiles::channels;
        const auto transform = [&](const auto& pixel) __attribute__((always_inline)) {
            for (std::size_t channel = 0; channel < tiles::channels; channel += tiles::input_width)
                transform_tile_input<words, side, side>(
                    [&](std::size_t y, std::size_t x) __attribute__((always_inline)) {
                        const std::uint8_t* const from = pixel(y, x);
                        return from ? __builtin_convertvector(load_bytes_as<bytes>(from + channel), words)
                                    : outside;
                    },
                    [&](std::size_t y, std::size_t x, const words& element) __attribute__((always_inline)) {
                        store_any(to + (y * side + x) * tiles::band * tiles::channels + channel, element);
                    });
        };
        if (top >= C.window.top && top + side <= C.window.top + image.rows && left >= C.window.left &&
            left + side <= C.window.left + image.columns) {
            const std::uint8_t* const corner =
                input + ((top - C.window.top) * image.columns + left - C.window.left) * C.input_stride;
            transform([corner](std::size_t y, std::size_t x) __attribute__((always_inline)) {
                return corner + (y * image.columns + x) * C.input_stride;
            });
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
        transform([&pixels](std::size_t y, std::size_t x)
                      __attribute__((always_inline)) { return pixels[y * side + x]; });
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

/// Writes the outputs of the tiles [first, last): Aᵀ m A and the epilogue.
template <frame_convolution C, std::size_t Vectors, class Output>
[[gnu::flatten, gnu::noinline]] void
transform_integer_output(const std::int32_t* products, const integer_epilogue& epilogue, Output* output,
                         std::size_t first, std::size_t last) {
    using tiles = integer_tiles<C>;
    constexpr std::size_t width = tiles::width, side = tiles::side;
    using sum = int32_vec<width>;
    for (std::size_t tile = first; tile < last; ++tile) {
        const std::size_t top = tile / tiles::columns * 2, left = tile % tiles::columns * 2;
        const bool below = top + 1 < C.rows(), right = left + 1 < C.columns();
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v) {
            std::array<sum, side> half[2];
#pragma GCC unroll 64
            for (std::size_t x = 0; x < side; ++x) {
                std::array<sum, side> column;
#pragma GCC unroll 64
                for (std::size_t y = 0; y < side; ++y)
                    column[y] = load_bytes_as<sum>(
                        products + (((y * side + x) * tiles::band + tile - first) * Vectors + v) * width);
                const std::array<sum, 2> line = tile_output_line<2>(column);
                half[0][x] = line[0], half[1][x] = line[1];
            }
            const std::array<sum, 2> upper = tile_output_line<2>(half[0]),
                                     lower = tile_output_line<2>(half[1]);
            sum y[4]{upper[0], upper[1], lower[0], lower[1]};
            const sum start = epilogue.start<width>(v);
            const float_vec<width> factors = epilogue.factor<width>(v);
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
                epilogue.store<width, C.rectifies()>(output + tile * C.output_stride() + v * width, largest,
                                                     factors);
            } else {
#pragma GCC unroll 64
                for (std::size_t i = 0; i < 4; ++i) {
                    if ((i / 2 == 1 && !below) || (i % 2 == 1 && !right))
                        continue;
                    Output* const to =
                        output + ((top + i / 2) * C.output_columns() + left + i % 2) * C.output_stride() +
                        v * width;
                    if constexpr (C.accumulates)
                        y[i] += epilogue.added_term<width>(to, v);
                    epilogue.store<width, C.rectifies()>(to, y[i], factors);
                }
            }
        }
    }
}

} // namespace detail

/// Winograd convolution of bytes by tiles of 2 × 2 outputs; groups are one convolution with zeros between
/// them. Where one instruction multiplies four bytes, the direct method needs fewer.
template <frame_convolution C, class Input>
struct winograd_integer_method {
    static constexpr frame_convolution convolution = C.ungrouped();
    using tiles = integer_tiles<convolution>;
    static constexpr const char* name = "Winograd";
    static constexpr bool applicable = std::is_same_v<Input, std::uint8_t> && tiles::possible &&
                                       byte_products<tiles::width>::group < 4 &&
                                       tiles::block_of(tiles::count) * tiles::block_vectors >= 8;
    static constexpr std::size_t cost = tiles::cost, packed_elements = tiles::weight_bytes,
                                 workspace_elements = tiles::workspace_bytes;
    static constexpr int offset = 0;
    static constexpr std::size_t filter_places = C.padded_filters();
    static constexpr std::size_t place(std::size_t filter) { return filter; }

    template <class Weight>
    static constexpr void pack(const Weight& weight, std::int8_t* to) {
        pack_integer_tiles<convolution>(ungrouped_weight<C>(weight), to);
    }
    template <class Output>
    static void run(const std::int8_t* packed, const integer_epilogue& epilogue, const std::uint8_t* input,
                    Output* output, std::uint8_t* workspace) {
        auto* const transformed = reinterpret_cast<std::int16_t*>(workspace);
        auto* const products = reinterpret_cast<std::int32_t*>(workspace + tiles::transformed_bytes);
        const auto* const weights = reinterpret_cast<const std::int16_t*>(packed);
        blocked<tiles::count, tiles::band>([&](auto band, std::size_t first_tile) {
            detail::transform_integer_input<convolution>(input, transformed, first_tile, first_tile + band,
                                                         epilogue.padding);
            blocked<tiles::vectors, tiles::block_vectors>([&](auto vectors, std::size_t first_vector) {
                const std::size_t first = first_vector * tiles::width;
                const std::int16_t* const of_block =
                    weights + first * tiles::elements * tiles::groups * tiles::group;
                for (std::size_t e = 0; e < tiles::elements; ++e)
                    blocked<band, tiles::block>([&](auto count, std::size_t tile) {
                        detail::multiply_integer_tiles<convolution, vectors, count>(
                            transformed + (e * tiles::band + tile) * tiles::channels,
                            of_block + e * tiles::groups * tiles::group * vectors * tiles::width,
                            products + (e * tiles::band + tile) * vectors * tiles::width);
                    });
                detail::transform_integer_output<convolution, vectors>(
                    products, epilogue.from(first), output + first, first_tile, first_tile + band);
            });
        });
    }
};

}}} // namespace tactnet::kernels
