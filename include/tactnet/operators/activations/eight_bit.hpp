#pragma once

#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/activations/step.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// An elementwise activation in 8 bits: a clamp of bytes for a ReLU, otherwise a table with an output for
/// each byte.
template <class Function, shape Map, std::size_t Stride>
struct activation_step<eight_bit, Function, Map, Stride> : step_base<eight_bit, Map, Stride> {
    static constexpr bool clamps = detail::is_relu<Function>();
    /// A clamp keeps the range of its input.
    static constexpr folded_arrays arrays{range_of_input, !clamps ? range_of_output : folded_array{}};
    static constexpr std::size_t folded_elements = arrays.numbers();
    static constexpr std::size_t packed_elements = pad_to_cache_line<std::int8_t>(clamps ? 1 : 256);

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        if constexpr (clamps) {
            detail::store_byte(to, static_cast<double>(input.zero_point));
        } else {
            for (int byte = 0; byte < 256; ++byte) {
                const double value = Function::value((byte - static_cast<double>(input.zero_point)) *
                                                     static_cast<double>(input.scale));
                // What is not a number counts as zero.
                const double steps =
                    value == value ? std::clamp(value / static_cast<double>(result.scale), -512.0, 512.0) : 0;
                detail::store_byte(to + byte, std::clamp(static_cast<double>(detail::nearest_even(steps)) +
                                                             static_cast<double>(result.zero_point),
                                                         0.0, 255.0));
            }
        }
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        for (std::size_t e = 0; e < Map.area() * Stride; ++e)
            if constexpr (clamps)
                out[e] = std::max(in[e], detail::load_byte(packed_values));
            else
                out[e] = detail::load_byte(packed_values + in[e]);
    }
    /// For calibration.
    static void reference(const float*, const float* in, float* out) {
        using number = std::conditional_t<detail::takes_vectors<Function>, double, float>;
        for (std::size_t e = 0; e < Map.size(); ++e)
            out[e] = static_cast<float>(Function::value(static_cast<number>(in[e])));
    }
};

template <class Function, shape Map, std::size_t Stride>
struct activation_step<eight_bit::input_format, Function, Map, Stride>
    : activation_step<eight_bit, Function, Map, Stride>, detail::cannot_read_the_frame<Stride> {};

}} // namespace tactnet
