#pragma once

#include <tactnet/kernels/integer/elementwise.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/square_root/step.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A square root in 8 bits, of the sensor's words or of bytes: √(x + offset) − √offset, and 0 for x < 0.
template <class Input, shape Map, std::size_t Stride, class Offset>
struct square_root_step<eight_bit_between<Input, std::uint8_t>, Map, Stride, Offset>
    : step_base<eight_bit, Map, Stride> {
    static constexpr double offset = static_cast<double>(Offset::num) / static_cast<double>(Offset::den);
    static constexpr folded_arrays arrays{range_of_input, range_of_output};
    static constexpr std::size_t folded_elements = arrays.numbers();

private:
    // The offset in steps of the input, 1/1024 in steps of the output, the step of the input; then two bytes.
    static constexpr std::size_t of_offset = 0, of_part = of_offset + sizeof(float),
                                 of_step = of_part + sizeof(float), bytes = of_step + sizeof(float);

public:
    static constexpr std::size_t packed_elements = pad_to_cache_line<std::int8_t>(bytes + 2);

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        detail::store_number(to + of_offset, static_cast<float>(offset / static_cast<double>(input.scale)));
        detail::store_number(to + of_part,
                             static_cast<float>(1 / 1024.0 / static_cast<double>(result.scale)));
        detail::store_number(to + of_step, input.scale);
        detail::store_byte(to + bytes, static_cast<double>(input.zero_point));
        detail::store_byte(to + bytes + 1, static_cast<double>(result.zero_point));
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        const std::uint8_t input_zero = detail::load_byte(packed_values + bytes),
                           zero = detail::load_byte(packed_values + bytes + 1);
        // √(n · step + offset) = √step · √(n + offset ÷ step)
        const float factor = std::sqrt(kernels::load_bytes_as<float>(packed_values + of_step)) *
                             kernels::load_bytes_as<float>(packed_values + of_part);
        kernels::roots_to_bytes(reinterpret_cast<const Input*>(in), Map.area() * Stride, input_zero,
                                kernels::load_bytes_as<float>(packed_values + of_offset), factor,
                                {zero, 255, zero}, out);
    }
    /// For calibration.
    static void reference(const float*, const float* in, float* out) {
        for (std::size_t e = 0; e < Map.size(); ++e)
            out[e] = static_cast<float>(std::sqrt(std::max(static_cast<double>(in[e]), 0.0) + offset) -
                                        std::sqrt(offset));
    }
};

}} // namespace tactnet
