#pragma once

#include <tactnet/kernels/frame/pooling.hpp>
#include <tactnet/kernels/integer/elementwise.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/pooling/step.hpp>
#include <tactnet/tensor/pooling_windows.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// An average pool in 8 bits: sums of integers, divided as they are rounded.
template <class Output, pooling_windows Windows, std::size_t Channels, std::size_t Stride>
struct average_pool_step<eight_bit_between<std::uint8_t, Output>, Windows, Channels, Stride>
    : step_base<eight_bit, shape{Windows.rows.outputs, Windows.columns.outputs, Channels}, Stride> {
    static constexpr bool writes_bytes = std::is_same_v<Output, std::uint8_t>;
    static constexpr std::size_t number_elements = sizeof(Output); ///< bytes per number that it writes
    static constexpr folded_arrays arrays{range_of_input, writes_bytes ? range_of_output : folded_array{}};
    static constexpr std::size_t folded_elements = arrays.numbers();

private:
    static constexpr std::size_t input_zero = sizeof(float), zero = input_zero + 1; // after the factor

public:
    static constexpr std::size_t packed_elements = pad_to_cache_line<std::int8_t>(zero + 1);

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        detail::store_number(
            to, static_cast<float>(static_cast<double>(input.scale) / static_cast<double>(result.scale)));
        detail::store_byte(to + input_zero, static_cast<double>(input.zero_point));
        detail::store_byte(to + zero, static_cast<double>(result.zero_point));
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        const auto factor = kernels::load_bytes_as<float>(packed_values);
        const std::uint8_t zero_of_input = detail::load_byte(packed_values + input_zero);
        const kernels::byte_range range{0, 255, detail::load_byte(packed_values + zero)};
        Windows.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t divisor) {
            std::array<std::int32_t, Stride> sums{};
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x)
                    for (std::size_t c = 0; c < Stride; ++c)
                        sums[c] += in[(y * Windows.columns.size + x) * Stride + c] - zero_of_input;
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
    /// For calibration, whose maps are not aligned.
    static void reference(const float*, const float* in, float* out) {
        kernels::average_pixels<float>(Windows, Channels, in, out);
    }
};

/// Bilinear interpolation in 8 bits: means of bytes stand for means of numbers, so the map keeps its range.
template <shape Input, extent2d Output, std::size_t Stride>
struct resampling_step<eight_bit, interpolation::bilinear, Input, Output, Stride>
    : step_base<eight_bit, shape{Output.rows, Output.columns, Input.channels}, Stride> {
    static constexpr folded_arrays arrays{range_of_input};
    static constexpr std::size_t folded_elements = arrays.numbers(),
                                 packed_elements = pad_to_cache_line<std::int8_t>(1);
    using down = kernels::sampling_axis<interpolation::bilinear, Input.rows, Output.rows>;
    using along = kernels::sampling_axis<interpolation::bilinear, Input.columns, Output.columns>;

    static constexpr void pack(const float* from, std::int8_t* to) {
        detail::store_byte(to, static_cast<double>(arrays.read_ranges(from).input.zero_point));
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        kernels::resample_bytes<down, along, Stride>(in, detail::load_byte(packed_values), out);
    }
    /// For calibration.
    static void reference(const float*, const float* in, float* out) {
        for (const auto& above : down::table)
            for (const auto& beside : along::table)
                for (std::size_t c = 0; c < Input.channels; ++c) {
                    double sum = 0;
                    for (std::size_t y = 0; y < down::taps; ++y)
                        for (std::size_t x = 0; x < along::taps; ++x) {
                            const std::size_t pixel = (above.first + y) * Input.columns + beside.first + x;
                            sum += above.weights[y] * beside.weights[x] *
                                   static_cast<double>(in[pixel * Input.channels + c]);
                        }
                    *out++ = static_cast<float>(sum);
                }
    }
};

}} // namespace tactnet
