#pragma once

#include <tactnet/kernels/integer/elementwise.hpp>
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

}} // namespace tactnet
