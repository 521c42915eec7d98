#pragma once

#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/integer/convolution/dense.hpp>
#include <tactnet/kernels/integer/convolution/depthwise.hpp>
#include <tactnet/kernels/integer/convolution/direct.hpp>
#include <tactnet/kernels/integer/convolution/winograd.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/method_list.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The depthwise method for cores without vector instructions: the taps of each channel one by one.
template <frame_convolution C, class Input>
struct scalar_depthwise_method {
    static constexpr const char* name = "depthwise, scalar";
    static constexpr bool applicable = C.is_depthwise() && C.filters == C.groups &&
                                       std::is_same_v<Input, std::uint8_t> && max_integer_lanes == 1;
    static constexpr std::size_t vector_instructions =
        2 * C.rows() * C.columns() * C.window.kernel.area() * C.filters;
    static constexpr std::size_t packed_elements = C.window.kernel.area() * C.filters; ///< [tap][channel]
    static constexpr std::size_t workspace_elements = C.filters; ///< a pixel of the padding
    static constexpr int offset = 0;
    static constexpr std::size_t filter_places = C.padded_filters();
    static constexpr std::size_t place(std::size_t filter) { return filter; }

    template <class Weight>
    static constexpr void pack(const Weight& weight, std::int8_t* to) {
        pack_taps(weight, C.filters, C.filters, C.filters, 1, C.window.kernel, to);
    }
    template <class Output>
    static void run(const std::int8_t* packed, const integer_epilogue& epilogue, const std::uint8_t* input,
                    Output* output, std::uint8_t* workspace) {
        constexpr std::size_t area = C.window.kernel.area();
        std::memset(workspace, epilogue.padding, C.filters);
        std::array<const std::uint8_t*, C.pool.area() * area> taps;
        for (std::size_t o = 0; o < C.output_rows() * C.output_columns(); ++o, output += C.output_stride()) {
            const std::size_t top = o / C.output_columns() * C.pool.rows,
                              left = o % C.output_columns() * C.pool.columns;
            std::size_t count = 0;
            for (std::size_t y = top; y < std::min(top + C.pool.rows, C.rows()); ++y)
                for (std::size_t x = left; x < std::min(left + C.pool.columns, C.columns()); ++x)
                    for (std::size_t tap = 0; tap < area; ++tap)
                        taps[count++] = pixel(input, workspace, y, x, tap);
            for (std::size_t f = 0; f < C.padded_filters(); ++f) {
                int32_vec<1> start = epilogue.start<1>(f), largest{};
                if constexpr (C.accumulates)
                    start += epilogue.added_term<1>(output + f, f);
                for (std::size_t first = 0; first < count; first += area) {
                    std::int32_t sum = start[0];
                    for (std::size_t tap = 0; f < C.filters && tap < area; ++tap)
                        sum += packed[tap * C.filters + f] * taps[first + tap][f];
                    largest[0] = first == 0 ? sum : std::max<std::int32_t>(largest[0], sum);
                }
                epilogue.store<1, C.rectifies()>(output + f, largest, epilogue.factor<1>(f));
            }
        }
    }

private:
    /// The input pixel under a tap, or the padding.
    static const std::uint8_t* pixel(const std::uint8_t* input, const std::uint8_t* padding, std::size_t y,
                                     std::size_t x, std::size_t tap) {
        const std::size_t row = y * C.window.stride.rows + tap / C.window.kernel.columns - C.window.top,
                          column =
                              x * C.window.stride.columns + tap % C.window.kernel.columns - C.window.left;
        const bool inside =
            row < C.window.input.rows && column < C.window.input.columns; // wraps around below 0
        return inside ? input + (row * C.window.input.columns + column) * C.input_stride : padding;
    }
};

// The methods for a convolution of one frame in integers (method_list.hpp). All give the same exact sums. The
// unit of their costs is an instruction on a vector, and an element is a byte. In addition to the members
// of every method they have
//   offset               what is subtracted from an input of 8 bits before it is multiplied
//   filter_places        elements of the arrays of the epilogue
//   place(filter)        where the elements of a filter lie in them
//   pack(weight, to)     into zeros; weight(filter, channel of its group, row, column) is a signed byte
//   run(packed, epilogue, input, output, workspace)

/// The method that computes a convolution of inputs of type `Input`: bytes, or words of 16 bits.
template <frame_convolution C, class Input>
using integer_method =
    typename method_list<direct_integer_method<C, Input>, winograd_integer_method<C, Input>,
                         depthwise_integer_method<C, Input>, scalar_depthwise_method<C, Input>,
                         dense_integer_method<C, Input>>::cheapest;

}}} // namespace tactnet::kernels
