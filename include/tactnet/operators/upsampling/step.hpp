#pragma once

#include <tactnet/kernels/frame/resampling.hpp>
#include <tactnet/kernels/sampling_axis.hpp>
#include <tactnet/lowering/step.hpp>

#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Resamples a map to another size.
template <class Format, interpolation Mode, shape Input, extent2d Output, std::size_t Stride>
struct resampling_step;
template <class Format, interpolation Mode, shape Input, extent2d Output, std::size_t Stride>
struct step_description<resampling_step<Format, Mode, Input, Output, Stride>> {
    static constexpr const char* header = "tactnet/operators/upsampling/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::resampling_step",
           Mode == interpolation::nearest ? "Nearest upsampling" : "Bilinear upsampling",
           std::type_identity<Format>{}, Mode, Input, Output, input_stride_argument{});
    }
};

template <interpolation Mode, shape Input, extent2d Output, std::size_t Stride>
struct resampling_step<single_precision, Mode, Input, Output, Stride>
    : step_base<single_precision, shape{Output.rows, Output.columns, Input.channels}, Stride> {
    static constexpr std::size_t workspace_elements =
        Mode == interpolation::nearest ? 0 : 2 * pad_to_cache_line(Output.columns * Stride);

    static void run(const float*, const float* in, float* out, float* memory) noexcept {
        using down = kernels::sampling_axis<Mode, Input.rows, Output.rows>;
        using along = kernels::sampling_axis<Mode, Input.columns, Output.columns>;
        if constexpr (Mode == interpolation::nearest)
            kernels::copy_nearest<down, along, Stride>(in, out);
        else
            kernels::resample_frame<down, along, Stride>(in, out, memory);
    }
};

}} // namespace tactnet
