#pragma once

#include <tactnet/deployment/eight_bit/format.hpp>
#include <tactnet/deployment/steps/resampling.hpp>
#include <tactnet/kernels/integer/resampling.hpp>

#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Resampling in 8 bits: means of bytes stand for means of numbers, so the map keeps its range.
template <interpolation Mode, shape Input, extent2d Output, std::size_t Stride>
struct resampling_step<eight_bit, Mode, Input, Output, Stride>
    : step_base<eight_bit, shape{Output.rows, Output.columns, Input.channels}, Stride> {
    using down = kernels::sampling_axis<Mode, Input.rows, Output.rows>;
    using along = kernels::sampling_axis<Mode, Input.columns, Output.columns>;

    static void run(const std::int8_t*, const std::uint8_t* in, std::uint8_t* out, std::uint8_t*) noexcept {
        if constexpr (Mode == interpolation::nearest)
            kernels::copy_nearest<down, along, Stride>(in, out);
        else
            kernels::resample_bytes<down, along, Stride>(in, out);
    }
    /// For calibration.
    static void reference(const float*, const float* in, float* out) {
        for (const auto& above : down::table)
            for (const auto& beside : along::table)
                for (std::size_t c = 0; c < Input.channels; ++c) {
                    double sum = 0;
                    for (std::size_t y = 0; y < down::taps; ++y)
                        for (std::size_t x = 0; x < along::taps; ++x)
                            sum += above.weights[y] * beside.weights[x] *
                                   static_cast<double>(
                                       in[((above.first + y) * Input.columns + beside.first + x) *
                                              Input.channels +
                                          c]);
                    *out++ = static_cast<float>(sum);
                }
    }
};

template <interpolation Mode, shape Input, extent2d Output, std::size_t Stride>
struct resampling_step<eight_bit::input_format, Mode, Input, Output, Stride>
    : resampling_step<eight_bit, Mode, Input, Output, Stride>, detail::cannot_read_the_frame<Stride> {};

}} // namespace tactnet
