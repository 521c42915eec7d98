#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/frame_convolution.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <type_traits>

// How the direct method lays out inputs and weights. The input is staged: copied with its padding around it,
// in the type that the instruction set multiplies, so that a group of inputs that one instruction multiplies
// is contiguous: channels of one pixel or, if a pixel has fewer, channels of neighbours in a row.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The products for inputs of type `Input` by vectors of `Width` integers; by pairs of neighbours in a row if
/// there are any.
template <class Input, std::size_t Width, bool Neighbours, class Set>
constexpr auto direct_products(Set) {
    if constexpr (!std::is_same_v<Input, std::uint8_t>)
        return word_products<Width>{};
    else if constexpr (Width == 4 && Neighbours && requires { typename Set::pairs; })
        return typename Set::pairs{};
    else
        return byte_products<Width>{};
}

/// The layout for a fused convolution without groups, from inputs of type `Input`: bytes or words of 16 bits.
template <frame_convolution C, class Input>
struct direct_integer_layout {
    static_assert(C.groups == 1);
    static constexpr frame_convolution convolution = C;
    static constexpr std::size_t width = std::min(C.width(), max_integer_lanes);
    using products = decltype(direct_products<Input, width, (C.columns() > 1)>(instructions{}));
    /// Whether products are those of two neighbours in a row.
    static constexpr bool in_pairs = requires { &products::exchange; };
    using staged = typename products::staged;
    static constexpr std::size_t group = products::group;
    /// Subtracted from inputs as they are staged.
    static constexpr int offset = std::is_same_v<Input, std::uint8_t> ? products::offset : 0;

    /// The register block: the one of floats, or a smaller one where integer sums have fewer registers.
    static constexpr std::size_t vectors = C.padded_filters() / width;
    static constexpr bool few_registers = requires { products::max_sums; };
    static constexpr std::size_t block_vectors = [] {
        if constexpr (few_registers)
            return C.pool.area() > 1
                       ? std::size_t{1}
                       : std::gcd(vectors, products::max_sums / std::min<std::size_t>(C.columns(), 2));
        else if constexpr (C.rows() * C.columns() == 1) // enough sums that products need not wait for another
            return ceil_div(vectors, ceil_div(vectors, max_block_sums));
        else
            return C.block_vectors();
    }();
    static constexpr std::size_t block_rows = [] {
        if constexpr (few_registers)
            return C.pool.rows;
        else
            return C.block_rows();
    }();
    static constexpr std::size_t block_columns = [] {
        if constexpr (few_registers)
            return C.pool.area() > 1 ? C.pool.columns
                                     : std::min<std::size_t>(products::max_sums / block_vectors, C.columns());
        else
            return C.block_columns();
    }();

    /// The staged input: elements from one pixel to the next, a multiple or a fraction of the group; elements
    /// from one row to the next; rows; all elements, with those that the last group may read after its taps.
    static constexpr std::size_t stride =
        C.input_stride < group ? std::bit_ceil(C.input_stride) : round_up(C.input_stride, group);
    static constexpr std::size_t pitch = (C.window.input.columns + C.window.left + C.window.right) * stride;
    static constexpr std::size_t rows = C.window.input.rows + C.window.top + C.window.bottom;
    /// Whether the input already lies as the staged one would, as under a kernel of 1 × 1.
    static constexpr bool in_place = std::is_same_v<Input, staged> && stride == C.input_stride &&
                                     C.window.top + C.window.bottom + C.window.left + C.window.right == 0 &&
                                     stride % group == 0;
    static constexpr std::size_t staged_elements = in_place ? 0 : rows * pitch + group;

    /// Groups per pixel, columns per group, groups that cover the columns of the kernel.
    static constexpr std::size_t groups_of_pixel = std::max<std::size_t>(stride / group, 1),
                                 columns_of_group = std::max<std::size_t>(group / stride, 1),
                                 groups_of_row = ceil_div(C.window.kernel.columns, columns_of_group);
    static constexpr std::size_t weights_of_group = width * group;
    using weight = typename products::weight;
    static constexpr std::size_t weights =
        vectors * groups_of_pixel * C.window.kernel.rows * groups_of_row * weights_of_group;

    /// A group of staged inputs.
    [[nodiscard]] [[gnu::always_inline]] static typename products::inputs load(const staged* from) {
        if constexpr (few_registers) // which load general registers
            from = aligned<sizeof(staged) * std::gcd(stride, group)>(from);
        return products::broadcast(from);
    }

    /// Packs weights in the order of use: blocks of vectors of filters, then [group of the pixel][kernel
    /// row][group of the row][vector][filter][input of the group], with zeros where there is no filter or no
    /// tap. `weight(filter, channel, row, column)`.
    template <class Weight>
    static constexpr void pack(const Weight& weight_at, std::int8_t* packed) {
        const auto of_tap = [&](std::size_t filter, std::size_t in_pixel, std::size_t row, std::size_t in_row,
                                std::size_t element) {
            if constexpr (requires { products::order; })
                element = products::order[element];
            const std::size_t column = in_row * columns_of_group + element / stride;
            const std::size_t channel = in_pixel * group + element % stride;
            return filter < C.filters && column < C.window.kernel.columns && channel < C.window.input.channels
                       ? weight_at(filter, channel, row, column)
                       : std::int8_t{0};
        };
        for (std::size_t first = 0; first < vectors; first += block_vectors) {
            const std::size_t last = std::min(first + block_vectors, vectors);
            for (std::size_t in_pixel = 0; in_pixel < groups_of_pixel; ++in_pixel)
                for (std::size_t row = 0; row < C.window.kernel.rows; ++row)
                    for (std::size_t in_row = 0; in_row < groups_of_row; ++in_row)
                        for (std::size_t filter = first * width; filter < last * width; ++filter)
                            for (std::size_t element = 0; element < group; ++element) {
                                const auto value = of_tap(filter, in_pixel, row, in_row, element);
                                *packed++ = value;
                                for (std::size_t byte = 1; byte < sizeof(weight); ++byte)
                                    *packed++ = value < 0 ? std::int8_t{-1} : std::int8_t{0};
                            }
        }
    }

    /// Copies the input with its padding around it. `padding` stands for zero.
    static void stage(const Input* from, staged* to, Input padding) {
        constexpr std::size_t columns = C.window.input.columns;
        const auto convert = [](Input x) { return static_cast<staged>(x - offset); };
        const auto fill = [&](std::size_t pixels) {
            std::fill_n(to, pixels * stride, convert(padding));
            to += pixels * stride;
        };
        const auto copy = [&](std::size_t pixels) {
            if constexpr (std::is_same_v<Input, staged>)
                std::memcpy(to, from, pixels * C.input_stride * sizeof(staged));
            else
                for (std::size_t e = 0; e < pixels * C.input_stride; ++e)
                    to[e] = convert(from[e]);
            from += pixels * C.input_stride, to += pixels * stride;
        };
        fill(C.window.top * (pitch / stride) + C.window.left);
        for (std::size_t row = 0; row < C.window.input.rows; ++row) {
            if (row > 0)
                fill(C.window.left + C.window.right);
            if constexpr (stride == C.input_stride) {
                copy(columns);
            } else {
                for (std::size_t x = 0; x < columns; ++x) {
                    std::fill_n(to + C.input_stride, stride - C.input_stride, staged{});
                    copy(1);
                }
            }
        }
        fill(C.window.right + C.window.bottom * (pitch / stride));
        std::fill_n(to, group, staged{});
    }
};

}}} // namespace tactnet::kernels
