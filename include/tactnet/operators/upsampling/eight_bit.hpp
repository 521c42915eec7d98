#pragma once

#include <tactnet/kernels/frame/resampling.hpp>
#include <tactnet/kernels/integer/elementwise.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/upsampling/step.hpp>

#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Nearest pixels in 8 bits: bytes as they are.
template <shape Input, extent2d Output, std::size_t Stride>
struct resampling_step<eight_bit, interpolation::nearest, Input, Output, Stride>
    : step_base<eight_bit, shape{Output.rows, Output.columns, Input.channels}, Stride> {
    using down = kernels::sampling_axis<interpolation::nearest, Input.rows, Output.rows>;
    using along = kernels::sampling_axis<interpolation::nearest, Input.columns, Output.columns>;

    static void run(const std::int8_t*, const std::uint8_t* in, std::uint8_t* out, std::uint8_t*) noexcept {
        kernels::copy_nearest<down, along, Stride>(in, out);
    }
    /// For calibration, whose maps are not aligned.
    static void reference(const float*, const float* in, float* out) {
        kernels::copy_nearest<down, along, Input.channels, float, float>(in, out);
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
    /// For calibration (reference.hpp).
    static void reference(const float*, const float* in, float* out);
};

template <interpolation Mode, shape Input, extent2d Output, std::size_t Stride>
struct resampling_step<eight_bit::input_format, Mode, Input, Output, Stride>
    : resampling_step<eight_bit, Mode, Input, Output, Stride>, detail::cannot_read_the_frame<Stride> {};

}} // namespace tactnet
