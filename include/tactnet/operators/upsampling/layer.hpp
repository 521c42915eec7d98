#pragma once

#include <tactnet/kernels/batch/resampling.hpp>
#include <tactnet/kernels/sampling_axis.hpp>
#include <tactnet/operators/layer.hpp>

#include <cstddef>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <std::size_t Rows, std::size_t Columns>
[[nodiscard]] constexpr shape upsampled_output(std::size_t channels) {
    static_assert(Rows > 0 && Columns > 0,
                  "upsample: the factor, or the size, must have at least one row and one column");
    return {Rows, Columns, channels};
}

/// Resamples each channel to `Size`.
template <class Spec, class T, shape Input, extent2d Size, interpolation Mode>
struct resampled_layer : lane_block_layer<T, Input, Spec> {
    static constexpr shape output = upsampled_output<Size.rows, Size.columns>(Input.channels);
    static constexpr interpolation mode = Mode;

    static void forward_block(const T* in, T* out) {
        for (std::size_t channel = 0; channel < Input.channels; ++channel) {
            T* const to = out + channel * output_plane;
            kernels::resample_lanes<T, down, along>(in + channel * input_plane,
                                                    [&](std::size_t pixel, const kernels::vector<T>& value) {
                                                        kernels::store(to + pixel * kernels::lanes<T>, value);
                                                    });
        }
    }
    static void backward_block(const T*, const T*, const T* out_gradient, T* in_gradient) {
        for (std::size_t channel = 0; channel < Input.channels; ++channel) {
            const T* const from = out_gradient + channel * output_plane;
            kernels::resample_lanes_backward<T, down, along>(
                [&](std::size_t pixel) { return kernels::load(from + pixel * kernels::lanes<T>); },
                in_gradient + channel * input_plane);
        }
    }

private:
    using down = kernels::sampling_axis<Mode, Input.rows, output.rows>;
    using along = kernels::sampling_axis<Mode, Input.columns, output.columns>;
    static constexpr std::size_t input_plane = Input.area() * kernels::lanes<T>,
                                 output_plane = output.area() * kernels::lanes<T>;
};

} // namespace detail

/// Enlarges each channel by a whole factor for rows and columns, at least 1: PyTorch's
/// nn.Upsample(scale_factor=…, mode='nearest' or 'bilinear', align_corners=False). The output has rows ×
/// Factor.rows and columns × Factor.columns.
template <extent2d Factor, interpolation Mode = interpolation::nearest>
struct upsample {
    static constexpr std::string_view name = "upsample";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = {input.rows * Factor.rows, input.columns * Factor.columns, input.channels}};
    }

    template <class T, shape Input>
    using layer =
        detail::resampled_layer<upsample, T, Input,
                                extent2d(Input.rows* Factor.rows, Input.columns* Factor.columns), Mode>;
};

/// Resamples each channel to a given size, at least 1 × 1: PyTorch's nn.Upsample(size=…, mode='nearest' or
/// 'bilinear', align_corners=False). It also shrinks, as there, without antialiasing.
template <extent2d Size, interpolation Mode = interpolation::nearest>
struct upsample_to {
    static constexpr std::string_view name = "upsample";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = {Size.rows, Size.columns, input.channels}};
    }

    template <class T, shape Input>
    using layer = detail::resampled_layer<upsample_to, T, Input, Size, Mode>;
};

}} // namespace tactnet
