#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/integer/interleave.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/transpose.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

// A dense layer of one frame in integers: a convolution with a kernel as large as the map. The bytes of the
// map lie in lanes, one after the other, and are multiplied with as many weights of each filter in turn. A
// filter has a vector of sums, whose lanes are added at the end: no lane is spent on filters that do not
// exist, and there are as many sums as filters, so that products do not wait for one another.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// Adds the lanes of each vector: lane i of the result is the sum of vector i.
template <std::size_t Distance, class Vector, std::size_t Count>
[[nodiscard]] [[gnu::always_inline]] inline Vector add_lanes_of_each(std::array<Vector, Count>& vectors) {
    if constexpr (Distance < Count) {
#pragma GCC unroll 64
        for (std::size_t i = 0; i < Count; i += 2 * Distance) {
            exchange_lanes<Distance>(vectors[i], vectors[i + Distance], std::make_index_sequence<Count>{});
            vectors[i] += vectors[i + Distance];
        }
        return add_lanes_of_each<2 * Distance>(vectors);
    } else {
        return vectors[0];
    }
}

/// Writes the sums of `Filters` filters, padded to whole vectors, for an input of `Bytes` bytes.
template <std::size_t Lanes, std::size_t Bytes, std::size_t Filters>
[[gnu::flatten, gnu::noinline]] void add_dense_products(const std::uint8_t* input, const std::int8_t* weights,
                                                        std::int32_t* sums) {
    constexpr std::size_t step = 4 * Lanes, rest = Bytes % step;
    using products = byte_products<Lanes>;
    using sum = int32_vec<Lanes>;
    constexpr auto offset = static_cast<std::uint8_t>(products::offset);
    std::array<sum, round_up(Filters, Lanes)> all{};
    const auto add = [&](const uint8_vec<step>& bytes) __attribute__((always_inline)) {
        const uint8_vec<step> moved = bytes ^ offset;
        const auto x = load_bytes_as<typename products::inputs>(&moved);
#pragma GCC unroll 64
        for (std::size_t f = 0; f < Filters; ++f)
            all[f] = products::add(all[f], products::load(weights + f * step), x);
        weights += Filters * step;
    };
    for (std::size_t first = 0; first + step <= Bytes; first += step)
        add(load_bytes_as<uint8_vec<step>>(input + first));
    if constexpr (rest > 0)
        add(load_first<step, rest>(input + Bytes - rest));
#pragma GCC unroll 64
    for (std::size_t first = 0; first < Filters; first += Lanes) {
        std::array<sum, Lanes> some;
#pragma GCC unroll 64
        for (std::size_t i = 0; i < Lanes; ++i)
            some[i] = all[first + i];
        store_any(sums + first, add_lanes_of_each<1>(some));
    }
}

} // namespace detail

/// The method for dense layers of bytes, on instruction sets that multiply four bytes at once.
template <frame_convolution C, class Input>
struct dense_integer_method {
    static constexpr std::size_t lanes = max_integer_lanes, step = 4 * lanes;
    /// Bytes of the map up to the last channel of the last pixel.
    static constexpr std::size_t bytes =
        (C.window.input.area() - 1) * C.input_stride + C.window.input.channels;
    /// Filters of a register block, evenly spread.
    static constexpr std::size_t block =
        ceil_div(C.filters, ceil_div(C.filters, std::max<std::size_t>(max_block_sums, lanes)));

    static constexpr const char* name = "dense";
    static constexpr bool applicable =
        std::is_same_v<Input, std::uint8_t> && lanes > 1 && byte_products<lanes>::group == 4 &&
        C.groups == 1 && !C.accumulates && C.window.kernel.rows == C.window.input.rows &&
        C.window.kernel.columns == C.window.input.columns && C.window.output_rows() == 1 &&
        C.window.output_columns() == 1 && C.window.top == 0 && C.window.left == 0;
    /// Instructions for products and for adding lanes.
    static constexpr std::size_t vector_instructions =
        C.filters * ceil_div(bytes, step) + 4 * round_up(C.filters, lanes);
    static constexpr std::size_t packed_elements = C.filters * round_up(bytes, step),
                                 workspace_elements = pad_to_cache_line<std::uint8_t>(
                                     (C.filters + round_up(block, lanes)) * sizeof(std::int32_t));
    static constexpr int offset = byte_products<lanes>::offset;
    static constexpr std::size_t filter_places = C.padded_filters();
    static constexpr std::size_t place(std::size_t filter) { return filter; }

    /// Blocks of filters, then [vector of the input][filter][byte].
    template <class Weight>
    static constexpr void pack(const Weight& weight, std::int8_t* to) {
        for (std::size_t first = 0; first < C.filters; first += block)
            for (std::size_t from = 0; from < bytes; from += step)
                for (std::size_t f = first; f < std::min(first + block, C.filters); ++f)
                    for (std::size_t byte = from; byte < from + step; ++byte, ++to) {
                        const std::size_t pixel = byte / C.input_stride, channel = byte % C.input_stride;
                        *to = byte < bytes && channel < C.window.input.channels
                                  ? weight(f, channel, pixel / C.window.input.columns,
                                           pixel % C.window.input.columns)
                                  : std::int8_t{0};
                    }
    }
    template <class Output>
    static void run(const std::int8_t* packed, const integer_epilogue& epilogue, const std::uint8_t* input,
                    Output* output, std::uint8_t* workspace) {
        constexpr std::size_t width = std::min(C.width(), lanes);
        auto* const sums = reinterpret_cast<std::int32_t*>(workspace);
        blocked<C.filters, block>([&](auto filters, std::size_t first) {
            detail::add_dense_products<lanes, bytes, filters>(input, packed + first * round_up(bytes, step),
                                                              sums + first);
        });
        for (std::size_t v = 0; v < C.padded_filters() / width; ++v)
            epilogue.store<width, C.rectifies()>(output + v * width,
                                                 load_bytes_as<int32_vec<width>>(sums + v * width) +
                                                     epilogue.start<width>(v),
                                                 epilogue.factor<width>(v));
    }
};

}}} // namespace tactnet::kernels
