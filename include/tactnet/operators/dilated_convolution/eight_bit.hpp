#pragma once

#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/operators/dilated_convolution/step.hpp>

#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

/// In 8 bits the padding holds the byte that stands for zero.
template <sliding_window Window, extent2d Dilation, extent2d Outputs, std::size_t InputStride>
struct phase_splitting_step<eight_bit, Window, Dilation, Outputs, InputStride>
    : detail::phase_splitting<eight_bit, Window, Dilation, Outputs, InputStride> {
    static constexpr folded_arrays arrays{range_of_input};
    static constexpr std::size_t folded_elements = arrays.numbers(),
                                 packed_elements = pad_to_cache_line<std::int8_t>(1);

    static constexpr void pack(const float* from, std::int8_t* to) {
        detail::store_byte(to, static_cast<double>(arrays.read_ranges(from).input.zero_point));
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        phase_splitting_step::template split<InputStride>(in, detail::load_byte(packed_values), out);
    }
    /// For calibration.
    static void reference(const float*, const float* in, float* out) {
        phase_splitting_step::template split<Window.input.channels>(in, 0.0F, out);
    }
};

}} // namespace tactnet
