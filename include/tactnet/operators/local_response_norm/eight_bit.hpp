#pragma once

#include <tactnet/kernels/integer/norms.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/local_response_norm/step.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

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

template <shape Map, std::size_t Stride, class Rule>
struct local_response_norm_step<eight_bit::input_format, Map, Stride, Rule>
    : local_response_norm_step<eight_bit, Map, Stride, Rule>, detail::cannot_read_the_frame<Stride> {};

}} // namespace tactnet
