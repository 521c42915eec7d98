#pragma once

#include <tactnet/deployment/eight_bit/format.hpp>
#include <tactnet/deployment/eight_bit/quantise.hpp>
#include <tactnet/deployment/steps/elementwise.hpp>
#include <tactnet/kernels/integer/root.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A square root in 8 bits, of the sensor's words or of bytes: √(x + offset) − √offset, 0 for x below 0.
template <class Input, shape Map, std::size_t Stride, class Offset>
struct square_root_step<eight_bit_between<Input, std::uint8_t>, Map, Stride, Offset> {
    using format = eight_bit;
    static constexpr shape output = Map;
    static constexpr std::size_t output_stride = Stride;
    static constexpr double offset = static_cast<double>(Offset::num) / static_cast<double>(Offset::den);
    static constexpr std::size_t ranges = 2;
    static constexpr folded_arrays arrays{range_array("input"), range_array("output")};
    static constexpr std::size_t folded = arrays.numbers();

private:
    // In steps of the input, of an output of 1/1024 where a step is 1, and the root of that step; then two
    // bytes.
    static constexpr std::size_t of_offset = 0, of_part = of_offset + sizeof(float),
                                 of_step = of_part + sizeof(float), bytes = of_step + sizeof(float);

public:
    static constexpr std::size_t packed = whole_lines<std::int8_t>(bytes + 2), workspace_elements = 0;

    static constexpr void set_ranges(float* to, const step_ranges& values) {
        values.input.write(to);
        values.output.write(to + map_range::numbers);
    }
    static constexpr void pack(const float* from, std::int8_t* to) {
        const map_range input = map_range::read(from), result = map_range::read(from + map_range::numbers);
        const auto as_byte = [](float value) {
            return static_cast<std::int8_t>(static_cast<std::uint8_t>(value));
        };
        detail::store_number(to + of_offset, static_cast<float>(offset / static_cast<double>(input.scale)));
        detail::store_number(to + of_part,
                             static_cast<float>(1 / 1024.0 / static_cast<double>(result.scale)));
        detail::store_number(to + of_step, input.scale);
        to[bytes] = as_byte(input.zero), to[bytes + 1] = as_byte(result.zero);
    }
    static double output_bound(const float*, double input) { return std::max(input, 1.0) + offset; }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        const auto byte = [&](std::size_t which) {
            return static_cast<std::uint8_t>(packed_values[bytes + which]);
        };
        // √(n · step + offset) = √step · √(n + offset ÷ step)
        const float factor = std::sqrt(kernels::load_any<float>(packed_values + of_step)) *
                             kernels::load_any<float>(packed_values + of_part);
        kernels::roots_to_bytes(reinterpret_cast<const Input*>(in), Map.area() * Stride, byte(0),
                                kernels::load_any<float>(packed_values + of_offset), factor,
                                {byte(1), 255, byte(1)}, out);
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
