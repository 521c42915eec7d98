#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/integer/norms.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/sample_norms/step.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A group, instance or layer norm in 8 bits: the moments of bytes are exact integers, and each output is
/// rounded from 1/256 of a step (kernels/integer/norms.hpp).
template <shape Map, std::size_t Stride, unsigned Kind, std::size_t Groups, bool Rectified>
struct sample_norm_step<eight_bit, Map, Stride, Kind, Groups, Rectified> : step_base<eight_bit, Map, Stride> {
private:
    static constexpr auto kind = static_cast<sample_norm_kind>(Kind);
    static constexpr bool of_pixels = kind == sample_norm_kind::pixels,
                          per_element = kind == sample_norm_kind::frame;
    using kernel_norm = kernels::byte_norm;
    static constexpr kernel_norm norm{.pixels = Map.area(),
                                      .channels = Map.channels,
                                      .stride = Stride,
                                      .groups = Groups,
                                      .weight_per_element = per_element};
    using method =
        std::conditional_t<of_pixels, kernels::byte_pixel_norm<norm>, kernels::byte_group_norm<norm>>;
    static constexpr std::size_t weights = per_element ? Map.size() : Map.channels,
                                 values_together =
                                     of_pixels ? Map.channels : Map.channels / Groups * Map.area();
    static constexpr folded_array one_for_each(const char* name) {
        return per_element ? folded_array{name, folded_kind::numbers, {Map.channels, Map.rows, Map.columns}}
                           : folded_array{name, folded_kind::numbers, {Map.channels}};
    }

public:
    static constexpr folded_arrays arrays{one_for_each("weight"),
                                          one_for_each("bias"),
                                          {"epsilon", folded_kind::positive_numbers, {1}},
                                          range_of_input,
                                          range_of_output};
    static constexpr std::size_t folded_elements = arrays.numbers();

private:
    // Weights, biases, the margin, then the lowest byte and the zero.
    static constexpr std::size_t biases =
        pad_to_cache_line<std::int8_t>((per_element ? Map.area() : 1) * Stride * sizeof(float));
    static constexpr std::size_t margin = 2 * biases, lowest = margin + sizeof(float), zero = lowest + 1;

public:
    static constexpr std::size_t packed_elements = pad_to_cache_line<std::int8_t>(zero + 1);
    static constexpr std::size_t workspace_elements = method::memory_bytes;

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        const double parts = static_cast<double>(kernel_norm::parts) / static_cast<double>(result.scale);
        // `most` and `least` keep products and 1 ÷ √margin finite; larger biases are rejected.
        constexpr double most = 1e38, most_bias = static_cast<double>(kernel_norm::most_parts), least = 1e-30;
        for (std::size_t w = 0; w < weights; ++w) {
            const std::size_t place = per_element ? w % Map.area() * Stride + w / Map.area() : w;
            const double weight = static_cast<double>(from[w]) * parts,
                         bias = static_cast<double>(from[weights + w]) * parts;
            detail::store_number(to + 4 * place, static_cast<float>(std::clamp(weight, -most, most)));
            detail::store_number(to + biases + 4 * place, static_cast<std::int32_t>(detail::nearest_even(
                                                              std::clamp(bias, -most_bias, most_bias))));
        }
        const auto count = static_cast<double>(values_together), step = static_cast<double>(input.scale);
        detail::store_number(
            to + margin,
            static_cast<float>(std::clamp(
                static_cast<double>(from[2 * weights]) * (count / step) * (count / step), least, most)));
        const auto zero_byte = static_cast<double>(result.zero_point);
        detail::store_byte(to + lowest, Rectified ? zero_byte : 0);
        detail::store_byte(to + zero, zero_byte);
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        const kernels::byte_range range{detail::load_byte(packed_values + lowest), 255,
                                        detail::load_byte(packed_values + zero)};
        method::run({packed_values, packed_values + biases,
                     kernels::load_bytes_as<float>(packed_values + margin), range},
                    in, out, memory);
    }
    /// For calibration (reference.hpp).
    static void reference(const float* from, const float* in, float* out);
};

namespace detail {

/// The constants that 8 bits can take. A base, so that no errors follow in the step.
template <std::size_t Size, class Beta>
struct byte_response_limits {
    static_assert(kernels::exponent_of_roots<Beta>,
                  "local_response_norm: in 8 bits beta must be 1/2, 3/4 or 1; exponent_of_roots shows it");
    static_assert(Size * 255 * 255 <= 1 << 24,
                  "local_response_norm: in 8 bits a window holds at most 258 channels");
};

} // namespace detail

/// A local response normalisation in 8 bits, for the exponents that square roots compute.
template <shape Map, std::size_t Stride, std::size_t Size, class Alpha, class Beta, class K>
struct local_response_norm_step<eight_bit, Map, Stride, kernels::response_rule<Size, Alpha, Beta, K>>
    : step_base<eight_bit, Map, Stride>, detail::byte_response_limits<Size, Beta> {
    using rule = kernels::response_rule<Size, Alpha, Beta, K>;
    static constexpr folded_arrays arrays{range_of_input, range_of_output};
    static constexpr std::size_t folded_elements = arrays.numbers();
    static constexpr std::size_t packed_elements =
        pad_to_cache_line<std::int8_t>(sizeof(kernels::byte_response_constants));

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        // Beyond these bounds, the sum of squares or the margin has no influence on the other.
        constexpr double least = 1e-24, most = 1e24;
        const auto step = static_cast<double>(input.scale);
        const double of_square = rule::share * step * step;
        const double margin = of_square * most > rule::k ? std::max(rule::k / of_square, least) : most;
        const auto bytes = detail::bits_as<std::array<std::int8_t, sizeof(kernels::byte_response_constants)>>(
            kernels::byte_response_constants{
                static_cast<float>(margin), static_cast<float>(step / static_cast<double>(result.scale)),
                static_cast<std::int32_t>(input.zero_point), static_cast<std::int32_t>(result.zero_point)});
        std::copy(bytes.begin(), bytes.end(), to);
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        kernels::normalise_byte_responses<rule, Map.channels, Stride>(
            Map.area(), kernels::load_bytes_as<kernels::byte_response_constants>(packed_values), in, out);
    }
    /// For calibration (reference.hpp).
    static void reference(const float*, const float* in, float* out);
};

}} // namespace tactnet
