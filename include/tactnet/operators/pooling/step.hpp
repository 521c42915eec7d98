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

/// In every number format: in 8 bits the largest byte stands for the largest number.
template <format_of_maps Format, sliding_window Window, std::size_t Stride>
struct pool_step<Format, Window, Stride>
    : step_base<Format, shape{Window.output_rows(), Window.output_columns(), Window.input.channels}, Stride> {
    using number = typename Format::activation;
    static void run(const typename Format::packed_number*, const number* in, number* out, number*) noexcept {
        kernels::pool_frame<Window, Stride>(in, out);
    }
    /// For calibration, whose maps are not aligned.
    static void reference(const float*, const float* in, float* out) {
        kernels::largest_pixels<float>(windows_of(Window), Window.input.channels, in, out);
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

/// In every number format.
template <format_of_maps Format, shape Input, extent2d Output, std::size_t Stride>
struct adaptive_max_pool_step<Format, Input, Output, Stride>
    : step_base<Format, shape{Output.rows, Output.columns, Input.channels}, Stride> {
    using number = typename Format::activation;
    static constexpr pooling_windows bins{{Input.rows, Output.rows}, {Input.columns, Output.columns}};
    static void run(const typename Format::packed_number*, const number* in, number* out, number*) noexcept {
        kernels::pool_frame<Stride>(bins, in, out);
    }
    /// For calibration, whose maps are not aligned.
    static void reference(const float*, const float* in, float* out) {
        kernels::largest_pixels<float>(bins, Input.channels, in, out);
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

/// The nearest pixels, as they are in every number format.
template <format_of_maps Format, shape Input, extent2d Output, std::size_t Stride>
struct resampling_step<Format, interpolation::nearest, Input, Output, Stride>
    : step_base<Format, shape{Output.rows, Output.columns, Input.channels}, Stride> {
    using number = typename Format::activation;
    using down = kernels::sampling_axis<interpolation::nearest, Input.rows, Output.rows>;
    using along = kernels::sampling_axis<interpolation::nearest, Input.columns, Output.columns>;

    static void run(const typename Format::packed_number*, const number* in, number* out, number*) noexcept {
        kernels::copy_nearest<down, along, Stride>(in, out);
    }
    /// For calibration, whose maps are not aligned.
    static void reference(const float*, const float* in, float* out) {
        kernels::copy_nearest<down, along, Input.channels, float, float>(in, out);
    }
};

template <shape Input, extent2d Output, std::size_t Stride>
struct resampling_step<single_precision, interpolation::bilinear, Input, Output, Stride>
    : step_base<single_precision, shape{Output.rows, Output.columns, Input.channels}, Stride> {
    static constexpr std::size_t workspace_elements = 2 * pad_to_cache_line(Output.columns * Stride);

    static void run(const float*, const float* in, float* out, float* memory) noexcept {
        using down = kernels::sampling_axis<interpolation::bilinear, Input.rows, Output.rows>;
        using along = kernels::sampling_axis<interpolation::bilinear, Input.columns, Output.columns>;
        kernels::resample_frame<down, along, Stride>(in, out, memory);
    }
};

}} // namespace tactnet
