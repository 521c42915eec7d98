#pragma once

#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/batch_norm/step.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A separate batch norm in 8 bits, with or without ReLU: a weight of 16 bits per channel.
template <class Input, shape Map, std::size_t Stride, bool Rectified>
struct norm_step<eight_bit_between<Input, std::uint8_t>, Map, Stride, Rectified>
    : step_base<eight_bit, Map, Stride> {
    static constexpr folded_arrays arrays{{"weight", folded_kind::numbers, {Map.channels}},
                                          {"bias", folded_kind::numbers, {Map.channels}},
                                          range_of_input,
                                          range_of_output};
    static constexpr std::size_t folded_elements = arrays.numbers();

private:
    static constexpr std::size_t of_channels = pad_to_cache_line<std::int8_t>(Stride * sizeof(std::int32_t));
    static constexpr std::size_t starts = of_channels, factors = starts + of_channels,
                                 bytes = factors + of_channels;
    static constexpr std::size_t lowest = 0, zero = 1;

public:
    static constexpr std::size_t packed_elements = bytes + pad_to_cache_line<std::int8_t>(2);

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        for (std::size_t c = 0; c < Map.channels; ++c) {
            const auto weight = static_cast<double>(from[c]);
            const auto offset = static_cast<double>(from[Map.channels + c]);
            const double unit = detail::norm_unit(from[c], from[Map.channels + c], input);
            const std::int64_t times = detail::nearest_even(weight * static_cast<double>(input.scale) / unit);
            const std::int64_t start =
                detail::nearest_even(offset / unit) - times * static_cast<std::int64_t>(input.zero_point);
            detail::store_number(to + 4 * c, static_cast<std::int32_t>(times));
            detail::store_number(to + starts + 4 * c, static_cast<std::int32_t>(start));
            detail::store_number(to + factors + 4 * c,
                                 static_cast<float>(unit / static_cast<double>(result.scale)));
        }
        const auto zero_byte = static_cast<double>(result.zero_point);
        detail::store_byte(to + bytes + lowest, Rectified ? zero_byte : 0);
        detail::store_byte(to + bytes + zero, zero_byte);
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        const kernels::byte_range range{detail::load_byte(packed_values + bytes + lowest), 255,
                                        detail::load_byte(packed_values + bytes + zero)};
        const auto* const from = reinterpret_cast<const Input*>(in);
        for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride)
            for (std::size_t c = 0; c < Stride; ++c) {
                const auto times = kernels::load_bytes_as<std::int32_t>(packed_values + 4 * c),
                           start = kernels::load_bytes_as<std::int32_t>(packed_values + starts + 4 * c);
                kernels::store_rounded<1>(
                    out + pixel + c, kernels::int32_vec<1>{from[pixel + c] * times + start},
                    kernels::load_bytes_as<kernels::float_vec<1>>(packed_values + factors + 4 * c), range);
            }
    }
    /// For calibration.
    static void reference(const float* from, const float* in, float* out) {
        for (std::size_t e = 0; e < Map.size(); ++e) {
            out[e] = from[e % Map.channels] * in[e] + from[Map.channels + e % Map.channels];
            if (Rectified)
                out[e] = std::max(out[e], 0.0f);
        }
    }
};

}} // namespace tactnet
