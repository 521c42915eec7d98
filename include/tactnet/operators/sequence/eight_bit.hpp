#pragma once

#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/sequence/step.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

/// (byte − zero point) × scale.
template <shape Map, std::size_t Stride>
struct float_output_step<eight_bit, Map, Stride> : step_base<eight_bit, Map, Stride> {
    static constexpr std::size_t number_elements = sizeof(float);
    static constexpr folded_arrays arrays{range_of_input};
    static constexpr std::size_t folded_elements = arrays.numbers(),
                                 packed_elements = pad_to_cache_line<std::int8_t>(sizeof(map_range));

    static constexpr void pack(const float* from, std::int8_t* to) {
        for (std::size_t i = 0; i < map_range::numbers; ++i)
            detail::store_number(to + 4 * i, from[i]);
    }
    static void reference(const float*, const float* in, float* out) { std::copy_n(in, Map.size(), out); }
    static void run(const std::int8_t* packed, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        const auto range = kernels::load_bytes_as<map_range>(packed);
        auto* const numbers = reinterpret_cast<float*>(out);
        for (std::size_t e = 0; e < Map.area() * Stride; ++e)
            numbers[e] = (static_cast<float>(in[e]) - range.zero_point) * range.scale;
    }
};

}} // namespace tactnet
