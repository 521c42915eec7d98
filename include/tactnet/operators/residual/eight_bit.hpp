#pragma once

#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/integer/elementwise.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/residual/step.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The sum of two maps in 8 bits: bytes times integers of 15 bits, requantised.
template <shape Map, std::size_t Stride>
struct sum_step<eight_bit, Map, Stride> : step_base<eight_bit, Map, Stride> {
    static constexpr bool adds = true;
    static constexpr folded_arrays arrays{range_of_input, range_of_added, range_of_output};
    static constexpr std::size_t folded_elements = arrays.numbers();
    static constexpr std::size_t packed_elements = pad_to_cache_line<std::int8_t>(sizeof(kernels::byte_sum));

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        const double unit =
            static_cast<double>(std::max(input.scale, added.scale)) / kernels::byte_sum::most_weight;
        const auto weight = [&](const map_range& range) {
            return static_cast<std::int32_t>(detail::nearest_even(static_cast<double>(range.scale) / unit));
        };
        kernels::byte_sum sum{{weight(added), weight(input)}, 0, 0, 0};
        sum.start = -static_cast<std::int32_t>(added.zero_point) * sum.weights[0] -
                    static_cast<std::int32_t>(input.zero_point) * sum.weights[1];
        sum.factor = static_cast<float>(unit / static_cast<double>(result.scale));
        sum.zero = static_cast<std::int32_t>(result.zero_point);
        const auto bytes = detail::bits_as<std::array<std::int8_t, sizeof(sum)>>(sum);
        std::copy(bytes.begin(), bytes.end(), to);
    }
    static void reference(const float*, const float* in, const float* added, float* out) {
        for (std::size_t e = 0; e < Map.size(); ++e)
            out[e] = in[e] + added[e];
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        kernels::load_bytes_as<kernels::byte_sum>(packed).add<Map.area() * Stride>(in, out);
    }
};

/// A map times factors in 8 bits: products of two bytes, each less its zero point, requantised. The range
/// "added" is that of the factors.
template <shape Map, std::size_t Stride>
struct product_step<eight_bit, Map, Stride> : step_base<eight_bit, Map, Stride> {
    static constexpr folded_arrays arrays{range_of_input, range_of_added, range_of_output};
    static constexpr std::size_t folded_elements = arrays.numbers();

private:
    // After the factor of the products, the zero points of input, factors and output.
    static constexpr std::size_t input_zero = sizeof(float), factor_zero = input_zero + 1,
                                 zero = factor_zero + 1;

public:
    static constexpr std::size_t packed_elements = pad_to_cache_line<std::int8_t>(zero + 1);

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, factors, result] = arrays.read_ranges(from);
        detail::store_number(
            to, static_cast<float>(static_cast<double>(input.scale) * static_cast<double>(factors.scale) /
                                   static_cast<double>(result.scale)));
        detail::store_byte(to + input_zero, static_cast<double>(input.zero_point));
        detail::store_byte(to + factor_zero, static_cast<double>(factors.zero_point));
        detail::store_byte(to + zero, static_cast<double>(result.zero_point));
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    const std::uint8_t* factors) noexcept {
        constexpr std::size_t width = std::min(kernels::widest_bytes(Stride), kernels::max_integer_lanes);
        const std::int32_t zero_of_input = detail::load_byte(packed_values + input_zero),
                           zero_of_factors = detail::load_byte(packed_values + factor_zero);
        const kernels::byte_range range{0, 255, detail::load_byte(packed_values + zero)};
        const auto scale = kernels::load_bytes_as<float>(packed_values) + kernels::float_vec<width>{};
        std::array<std::int32_t, Stride> steps;
        for (std::size_t c = 0; c < Stride; ++c)
            steps[c] = factors[c] - zero_of_factors;
        for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride)
            for (std::size_t c = 0; c < Stride; c += width) {
                const auto bytes = kernels::load_bytes_as<kernels::uint8_vec<width>>(in + pixel + c);
                const auto times = kernels::load_bytes_as<kernels::int32_vec<width>>(steps.data() + c);
                kernels::store_rounded<width>(
                    out + pixel + c, (kernels::instructions::to_int32<width>(bytes) - zero_of_input) * times,
                    scale, range);
            }
    }
    /// For calibration.
    static void reference(const float*, const float* in, const float* factors, float* out) {
        for (std::size_t e = 0; e < Map.size(); ++e)
            out[e] = in[e] * factors[e % Map.channels];
    }
};

}} // namespace tactnet
