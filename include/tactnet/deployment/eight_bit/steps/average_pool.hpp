#pragma once

#include <tactnet/deployment/eight_bit/format.hpp>
#include <tactnet/deployment/eight_bit/quantise.hpp>
#include <tactnet/deployment/steps/pooling.hpp>
#include <tactnet/kernels/integer/rounding.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// An average pool in 8 bits: sums of whole numbers, divided when they are rounded.
template <class Output, average_windows Windows, std::size_t Channels, std::size_t Stride>
struct average_pool_step<eight_bit_between<std::uint8_t, Output>, Windows, Channels, Stride> {
    using format = eight_bit;
    static constexpr shape output{Windows.rows.outputs, Windows.columns.outputs, Channels};
    static constexpr std::size_t output_stride = Stride;
    static constexpr bool writes_bytes = std::is_same_v<Output, std::uint8_t>;
    static constexpr std::size_t number_elements = sizeof(Output); ///< of a number that it writes, in bytes
    static constexpr std::size_t ranges = writes_bytes ? 2 : 1;
    static constexpr folded_arrays arrays{range_array("input"), range_array("output", writes_bytes)};
    static constexpr std::size_t folded = arrays.numbers();

private:
    static constexpr std::size_t bytes = sizeof(float); // behind the factor
    static constexpr std::size_t input_zero = 0, zero = 1;

public:
    static constexpr std::size_t packed = whole_lines<std::int8_t>(bytes + 2), workspace_elements = 0;

    static constexpr void set_ranges(float* to, const step_ranges& values) {
        values.input.write(to);
        if constexpr (writes_bytes)
            values.output.write(to + map_range::numbers);
    }
    static constexpr void pack(const float* from, std::int8_t* to) {
        const map_range input = map_range::read(from),
                        result = writes_bytes ? map_range::read(from + map_range::numbers) : map_range{};
        const auto as_byte = [](float value) {
            return static_cast<std::int8_t>(static_cast<std::uint8_t>(value));
        };
        detail::store_number(
            to, static_cast<float>(static_cast<double>(input.scale) / static_cast<double>(result.scale)));
        to[bytes + input_zero] = as_byte(input.zero);
        to[bytes + zero] = as_byte(result.zero);
    }
    static double output_bound(const float*, double input) { return input; }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        const auto byte = [&](std::size_t which) {
            return static_cast<std::uint8_t>(packed_values[bytes + which]);
        };
        const auto factor = kernels::load_any<float>(packed_values);
        const kernels::byte_range range{0, 255, byte(zero)};
        Windows.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t divisor) {
            std::array<std::int32_t, Stride> sums{};
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x)
                    for (std::size_t c = 0; c < Stride; ++c)
                        sums[c] += in[(y * Windows.columns.size + x) * Stride + c] - byte(input_zero);
            const float scale = factor / static_cast<float>(divisor);
            for (std::size_t c = 0; c < Stride; ++c) {
                if constexpr (writes_bytes)
                    kernels::store_rounded<1>(out + o * Stride + c, kernels::int32_vec<1>{sums[c]},
                                              kernels::float_vec<1>{scale}, range);
                else
                    reinterpret_cast<Output*>(out)[o * Stride + c] = static_cast<float>(sums[c]) * scale;
            }
        });
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
