#pragma once

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
struct resampled_layer : layer_base<T, Input, Spec> {
    static constexpr shape output = upsampled_output<Size.rows, Size.columns>(Input.channels);
    static constexpr interpolation mode = Mode;
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
