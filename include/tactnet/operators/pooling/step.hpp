#pragma once

#include <tactnet/kernels/frame/pooling.hpp>
#include <tactnet/kernels/frame/resampling.hpp>
#include <tactnet/kernels/sampling_axis.hpp>
#include <tactnet/lowering/step.hpp>

#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A max pool that no convolution has fused.
template <class Format, sliding_window Window, std::size_t Stride>
struct pool_step;
template <class Format, sliding_window Window, std::size_t Stride>
struct step_description<pool_step<Format, Window, Stride>> {
    static constexpr const char* header = "tactnet/operators/pooling/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::pool_step", "Max pool", std::type_identity<Format>{}, Window, input_stride_argument{});
    }
};

template <sliding_window Window, std::size_t Stride>
struct pool_step<single_precision, Window, Stride>
    : step_base<single_precision, shape{Window.output_rows(), Window.output_columns(), Window.input.channels},
                Stride> {
    static void run(const float*, const float* in, float* out, float*) noexcept {
        kernels::pool_frame<Window, Stride>(in, out);
    }
};

/// A max pool over bins as equal as possible, which may overlap.
template <class Format, shape Input, extent2d Output, std::size_t Stride>
struct adaptive_max_pool_step;
template <class Format, shape Input, extent2d Output, std::size_t Stride>
struct step_description<adaptive_max_pool_step<Format, Input, Output, Stride>> {
    static constexpr const char* header = "tactnet/operators/pooling/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::adaptive_max_pool_step", "Adaptive max pool", std::type_identity<Format>{}, Input,
           Output, input_stride_argument{});
    }
};

template <shape Input, extent2d Output, std::size_t Stride>
struct adaptive_max_pool_step<single_precision, Input, Output, Stride>
    : step_base<single_precision, shape{Output.rows, Output.columns, Input.channels}, Stride> {
    static void run(const float*, const float* in, float* out, float*) noexcept {
        constexpr pooling_windows bins{{Input.rows, Output.rows}, {Input.columns, Output.columns}};
        kernels::pool_frame<Stride>(bins, in, out);
    }
};

/// An average pool.
template <class Format, pooling_windows Windows, std::size_t Channels, std::size_t Stride>
struct average_pool_step;
template <class Format, pooling_windows Windows, std::size_t Channels, std::size_t Stride>
struct step_description<average_pool_step<Format, Windows, Channels, Stride>> {
    static constexpr const char* header = "tactnet/operators/pooling/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::average_pool_step", "Average pool", std::type_identity<Format>{}, Windows, Channels,
           input_stride_argument{});
    }
};

template <pooling_windows Windows, std::size_t Channels, std::size_t Stride>
struct average_pool_step<single_precision, Windows, Channels, Stride>
    : step_base<single_precision, shape{Windows.rows.outputs, Windows.columns.outputs, Channels}, Stride> {
    static void run(const float*, const float* in, float* out, float*) noexcept {
        kernels::average_frame<Windows, Stride>(in, out);
    }
};

/// Resamples a map to another size.
template <class Format, interpolation Mode, shape Input, extent2d Output, std::size_t Stride>
struct resampling_step;
template <class Format, interpolation Mode, shape Input, extent2d Output, std::size_t Stride>
struct step_description<resampling_step<Format, Mode, Input, Output, Stride>> {
    static constexpr const char* header = "tactnet/operators/pooling/step.hpp";
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
