#pragma once

#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/arch/compiler_vector.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/integer/convolution/winograd_tiles.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

// Winograd convolution of one frame of bytes in integers. winograd_tiles.hpp has the tiles and packs the
// kernels.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// `integer_input_line` as an argument.
struct integer_input_lines {
    [[gnu::always_inline]] auto operator()(const auto& d) const { return integer_input_line(d); }
};

/// transformed[element][tile][channel] = Bᵀ d B of the input tiles [first, last); pixels outside the image
/// are `padding`.
template <frame_convolution C, class Tiles>
[[gnu::flatten, gnu::noinline]] void transform_integer_input(const std::uint8_t* input,
                                                             std::int16_t* transformed, std::size_t first,
                                                             std::size_t last, std::uint8_t padding) {
    using words = int16_vec<Tiles::input_width>;
    using bytes = uint8_vec<Tiles::input_width>;
    constexpr std::size_t rows = Tiles::side.rows, columns = Tiles::side.columns;
    constexpr shape image = C.window.input;
    std::array<std::uint8_t, Tiles::channels> outside;
    outside.fill(padding);
    for (std::size_t tile = first; tile < last; ++tile) {
        // Counted with the padding.
        const std::size_t top = tile / Tiles::columns * Tiles::outputs.rows,
                          left = tile % Tiles::columns * Tiles::outputs.columns;
        std::array<const std::uint8_t*, Tiles::elements> pixels;
#pragma GCC unroll 1
        for (std::size_t row = 0; row < rows; ++row)
#pragma GCC unroll 64
            for (std::size_t column = 0; column < columns; ++column) {
                // Before the image, these differences wrap around and exceed its size as well.
                const std::size_t y = top + row - C.window.top, x = left + column - C.window.left;
                pixels[row * columns + column] = y < image.rows && x < image.columns
                                                     ? input + (y * image.columns + x) * C.input_stride
                                                     : outside.data();
            }
        std::int16_t* const to = transformed + (tile - first) * Tiles::channels;
        for (std::size_t channel = 0; channel < Tiles::channels; channel += Tiles::input_width)
            transform_tile_input<words, rows, columns>(
                [&](std::size_t y, std::size_t x) __attribute__((always_inline)) {
                    return instructions::to_int16<Tiles::input_width>(
                        load_bytes_as<bytes>(pixels[y * columns + x] + channel));
                },
                [&](std::size_t y, std::size_t x, const words& element) __attribute__((always_inline)) {
                    store_any(to + (y * columns + x) * Tiles::input_distance + channel, element);
                },
                integer_input_lines{});
    }
}

/// products[tile][filter] of one element and `Count` tiles: a matrix product over the channels.
template <class Tiles, std::size_t Vectors, std::size_t Count>
[[gnu::flatten, gnu::noinline]] void
multiply_integer_tiles(const std::int16_t* input, const std::int16_t* weights, std::int32_t* products) {
    using words = typename Tiles::products;
    using sum = int32_vec<Tiles::width>;
    register_block<sum, Count, Vectors> sums{};
    for (std::size_t g = 0; g < Tiles::groups; ++g) {
        typename words::weights w[Vectors];
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v)
            w[v] = words::load(weights + (g * Vectors + v) * Tiles::width * Tiles::group);
        prefetch_weights<Vectors * Tiles::width * Tiles::group * sizeof(*weights),
                         Tiles::tiling.weight_bytes(), Count>(
            weights + (Tiles::groups + g) * Vectors * Tiles::width * Tiles::group); // of the next element
#pragma GCC unroll 64
        for (std::size_t t = 0; t < Count; ++t) {
            const auto x = words::broadcast(input + t * Tiles::channels + g * Tiles::group);
#pragma GCC unroll 64
            for (std::size_t v = 0; v < Vectors; ++v)
                sums[t][v] = words::add(sums[t][v], w[v], x);
        }
    }
#pragma GCC unroll 64
    for (std::size_t i = 0; i < Count * Vectors; ++i)
        store_any(products + i * Tiles::width, sums[i / Vectors][i % Vectors]);
}

/// Writes the outputs of the tiles [first, last): Aᵀ m A and the epilogue.
template <frame_convolution C, class Tiles, std::size_t Vectors, class Output>
[[gnu::flatten, gnu::noinline]] void
transform_integer_output(const std::int32_t* products, const integer_epilogue& epilogue, Output* output,
                         std::size_t first, std::size_t last) {
    constexpr std::size_t width = Tiles::width, window = C.pool.area();
    constexpr std::size_t rows = Tiles::side.rows, columns = Tiles::side.columns, high = Tiles::outputs.rows,
                          across = Tiles::outputs.columns;
    using sum = int32_vec<width>;
    using wrapping = uint32_vec<width>;
    for (std::size_t tile = first; tile < last; ++tile) {
        const std::size_t top = tile / Tiles::columns * high, left = tile % Tiles::columns * across;
        const auto inside = [&](std::size_t row, std::size_t column) __attribute__((always_inline)) {
            return (C.rows() % high == 0 || top + row < C.rows()) &&
                   (C.columns() % across == 0 || left + column < C.columns());
        };
        for (std::size_t v = 0; v < Vectors; ++v, products += width) {
            std::array<std::array<wrapping, columns>, high> half;
#pragma GCC unroll 64
            for (std::size_t x = 0; x < columns; ++x) {
                std::array<wrapping, rows> column;
#pragma GCC unroll 64
                for (std::size_t y = 0; y < rows; ++y)
                    column[y] =
                        load_bytes_as<wrapping>(products + (y * columns + x) * Tiles::product_distance);
                const auto line = integer_output_line<high>(column);
#pragma GCC unroll 64
                for (std::size_t y = 0; y < high; ++y)
                    half[y][x] = line[y];
            }
            const sum start = epilogue.start<width>(v);
            const float_vec<width> factors = epilogue.factor<width>(v);
            std::array<std::array<sum, across>, C.pool.rows> y;
#pragma GCC unroll 64
            for (std::size_t row = 0; row < high; ++row) {
                const auto line = integer_output_line<across>(half[row]);
#pragma GCC unroll 64
                for (std::size_t x = 0; x < across; ++x) {
                    const wrapping exact = Tiles::inverse == 1 ? line[x] : line[x] * Tiles::inverse;
                    y[row % C.pool.rows][x] = (reinterpret_cast<sum>(exact) >> Tiles::shift) + start;
                }
                if ((row + 1) % C.pool.rows != 0)
                    continue;
                const std::size_t upper = row + 1 - C.pool.rows;
#pragma GCC unroll 64
                for (std::size_t x = 0; x < across; x += C.pool.columns) {
                    if (!inside(upper, x))
                        continue;
                    Output* const to =
                        output +
                        ((top + upper) / C.pool.rows * C.output_columns() + (left + x) / C.pool.columns) *
                            C.output_stride() +
                        v * width;
                    sum largest = y[0][x];
#pragma GCC unroll 64
                    for (std::size_t i = 1; i < window; ++i) {
                        const std::size_t below = i / C.pool.columns, right = x + i % C.pool.columns;
                        if (inside(upper + below, right))
                            largest = y[below][right] > largest ? y[below][right] : largest;
                    }
                    if constexpr (C.accumulates)
                        largest += epilogue.added_term<width>(to, v);
                    epilogue.store<width, C.rectifies()>(to, largest, factors);
                }
            }
        }
    }
}

} // namespace detail

/// Winograd convolution of bytes by tiles of so many outputs; groups are one convolution with zeros between
/// them.
template <frame_convolution C, extent2d Outputs>
struct integer_tile_method {
    static constexpr frame_convolution convolution = C.ungrouped();
    using tiles = integer_tiles<convolution, Outputs>;
    static constexpr const char* name = "Winograd";
    static constexpr bool applicable = true;
    static constexpr std::size_t vector_instructions = tiles::tiling.cost(),
                                 packed_elements = tiles::tiling.weight_bytes(),
                                 workspace_elements = tiles::workspace_bytes;
    static constexpr int offset = 0;
    static constexpr std::size_t filter_places = C.padded_filters();
    static constexpr std::size_t place(std::size_t filter) { return filter; }

    template <class Weight>
    static constexpr void pack(const Weight& weight, std::int8_t* to) {
        pack_integer_tiles<convolution, tiles>(ungrouped_weight<C>(weight), to);
    }
    template <class Output>
    static void run(const std::int8_t* packed, const integer_epilogue& epilogue, const std::uint8_t* input,
                    Output* output, std::uint8_t* workspace) {
        auto* const transformed = reinterpret_cast<std::int16_t*>(workspace);
        auto* const products = reinterpret_cast<std::int32_t*>(workspace + tiles::transformed_bytes);
        const auto* const weights = reinterpret_cast<const std::int16_t*>(packed);
        blocked<tiles::count, tiles::band>([&](auto band, std::size_t first_tile) {
            detail::transform_integer_input<convolution, tiles>(input, transformed, first_tile,
                                                                first_tile + band, epilogue.padding);
            blocked<tiles::vectors, tiles::block_vectors>([&](auto vectors, std::size_t first_vector) {
                const std::size_t first = first_vector * tiles::width;
                const std::int16_t* const of_block =
                    weights + first * tiles::elements * tiles::groups * tiles::group;
                for (std::size_t e = 0; e < tiles::elements; ++e)
                    blocked<band, tiles::block>([&](auto count, std::size_t tile) {
                        detail::multiply_integer_tiles<tiles, vectors, count>(
                            transformed + e * tiles::input_distance + tile * tiles::channels,
                            of_block + e * tiles::groups * tiles::group * vectors * tiles::width,
                            products + e * tiles::product_distance + tile * vectors * tiles::width);
                    });
                detail::transform_integer_output<convolution, tiles, vectors>(
                    products, epilogue.from(first), output + first, first_tile, first_tile + band);
            });
        });
    }
};

/// No tile is possible.
template <frame_convolution C>
struct integer_tile_method<C, extent2d(0)> {
    static constexpr bool applicable = false;
};

/// Winograd convolution by the cheapest tile, for inputs of bytes.
template <frame_convolution C, class Input>
struct winograd_integer_method
    : integer_tile_method<C, std::is_same_v<Input, std::uint8_t> ? best_integer_tile(C.ungrouped())
                                                                 : extent2d(0)> {};

}}} // namespace tactnet::kernels
