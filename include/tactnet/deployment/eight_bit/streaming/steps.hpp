#pragma once

#include <tactnet/deployment/eight_bit/streaming/causal_convolution.hpp>
#include <tactnet/deployment/eight_bit/streaming/frame_step.hpp>
#include <tactnet/deployment/eight_bit/streaming/frames.hpp>
#include <tactnet/deployment/eight_bit/streaming/recurrent.hpp>
#include <tactnet/kernels/integer/elementwise.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// All steps of streams in 8 bits; here those that are not in files of their own.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Activations: a clamp of bytes for a ReLU, otherwise a table.
template <class Out, class Function, std::size_t Features>
struct activation_stream_step<eight_bit_between<std::uint8_t, Out>, Function, Features>
    : detail::frame_stream_step<eight_bit_between<std::uint8_t, Out>,
                                activation_stream_step<single_precision, Function, Features>, std::uint8_t,
                                detail::byte_activation<Function, Features>,
                                !detail::byte_activation<Function, Features>::clamps> {};

/// What changes nothing.
template <class In, class Out, std::size_t Features>
struct copying_stream_step<eight_bit_between<In, Out>, Features>
    : detail::byte_stream_step<eight_bit_between<In, Out>, In,
                               copying_stream_step<single_precision, Features>> {
    using exact = copying_stream_step<single_precision, Features>;
    using state = typename detail::byte_stream_step<eight_bit_between<In, Out>, In, exact>::state;
    static constexpr bool observes_output = false;
    static constexpr std::size_t folded_elements = 0, packed_elements = 0, workspace_elements = 0;

    static void fold(const float*, float*) {}
    static map_range set_ranges(float*, const map_range& input, const map_range*&) { return input; }
    static void visit_arrays(auto&&) {}
    static constexpr void pack(const float*, std::int8_t*) {}
    static void run(const std::int8_t*, const std::uint8_t* in, state&, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        std::copy_n(in, Features * sizeof(In), out);
    }
};

/// The sum of two branches, whose bytes are multiplied by integers of 15 bits and requantised.
template <class Out, class Main, class Skip>
struct residual_stream_step<eight_bit_between<std::uint8_t, Out>, Main, Skip>
    : detail::byte_stream_step<eight_bit_between<std::uint8_t, Out>, std::uint8_t,
                               detail::residual_sizes<Main, Skip>> {
private:
    static constexpr std::size_t skip_offset = Main::packed_elements,
                                 sum_offset = skip_offset + Skip::packed_elements,
                                 inner_folded = Main::folded_elements + Skip::folded_elements;

public:
    static constexpr folded_arrays arrays{range_of_input, range_of_added, range_of_output};
    static constexpr std::size_t folded_elements = inner_folded + arrays.numbers(),
                                 packed_elements =
                                     sum_offset + pad_to_cache_line<std::int8_t>(sizeof(kernels::byte_sum)),
                                 workspace_elements =
                                     std::max(Main::workspace_elements, Skip::workspace_elements);

    struct state {
        [[no_unique_address]] typename Main::state of_main;
        [[no_unique_address]] typename Skip::state of_skip;
    };

    static void fold(const float* values, float* folded) {
        Main::fold(values, folded);
        Skip::fold(values + Main::parameters, folded + Main::folded_elements);
    }
    static map_range set_ranges(float* folded, const map_range& input, const map_range*& ranges) {
        step_ranges own;
        own.input = Main::set_ranges(folded, input, ranges);
        own.added = Skip::set_ranges(folded + Main::folded_elements, input, ranges);
        own.output = *ranges++;
        arrays.write_ranges(folded + inner_folded, own);
        return own.output;
    }
    static constexpr void pack(const float* folded, std::int8_t* packed) {
        Main::pack(folded, packed);
        Skip::pack(folded + Main::folded_elements, packed + skip_offset);
        const auto [input, added, result] = arrays.read_ranges(folded + inner_folded);
        const double unit =
            static_cast<double>(std::max(input.scale, added.scale)) / kernels::byte_sum::most_weight;
        const auto weight = [&](const map_range& range) {
            return static_cast<std::int32_t>(detail::nearest_even(static_cast<double>(range.scale) / unit));
        };
        kernels::byte_sum sum{{weight(input), weight(added)}, 0, 0, 0};
        sum.start = -static_cast<std::int32_t>(input.zero_point) * sum.weights[0] -
                    static_cast<std::int32_t>(added.zero_point) * sum.weights[1];
        sum.factor = static_cast<float>(unit / static_cast<double>(result.scale));
        sum.zero = static_cast<std::int32_t>(result.zero_point);
        const auto bytes = detail::bits_as<std::array<std::int8_t, sizeof(sum)>>(sum);
        std::copy(bytes.begin(), bytes.end(), packed + sum_offset);
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, state& s, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        alignas(vector_alignment) std::array<std::uint8_t, residual_stream_step::map_elements> added{};
        Main::run(packed, in, s.of_main, out, memory);
        Skip::run(packed + skip_offset, in, s.of_skip, added.data(), memory);
        kernels::load_bytes_as<kernels::byte_sum>(packed + sum_offset).add<Main::outputs>(added.data(), out);
    }
};

}} // namespace tactnet
