#pragma once

#include <tactnet/operators/layer.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Whether the padding of a transposed convolution on each side is smaller than its kernel.
template <std::size_t KernelRows, std::size_t KernelColumns, std::size_t MostRowsOfPadding,
          std::size_t MostColumnsOfPadding>
concept padding_below_kernel = (MostRowsOfPadding < KernelRows) && (MostColumnsOfPadding < KernelColumns);

namespace detail {

/// Pixels of a transposed convolution along one axis before it is cropped.
[[nodiscard]] constexpr std::size_t uncropped(std::size_t pixels, std::size_t kernel, std::size_t stride) {
    return (pixels - 1) * stride + kernel;
}

/// The convolution that a transposed one is the input gradient of: it reads a map of the output's size and
/// makes one of the input's. Its channels are the filters of the transposed convolution. A stride of zero
/// counts as one; the layer rejects it.
[[nodiscard]] constexpr sliding_window transposed_window(const shape& input, std::size_t filters,
                                                         extent2d kernel, extent2d stride, padding around) {
    const auto size = [&](std::size_t pixels, std::size_t kernel_size, std::size_t step, std::size_t crop) {
        step = std::max<std::size_t>(step, 1);
        if (around.how == padding::rule::same)
            return pixels * step;
        const std::size_t all = uncropped(pixels, kernel_size, step);
        return all > crop ? all - crop : 1;
    };
    return sliding_window::over(
        {size(input.rows, kernel.rows, stride.rows, around.top + around.bottom),
         size(input.columns, kernel.columns, stride.columns, around.left + around.right), filters},
        kernel, stride, around);
}

template <std::size_t Filters, std::size_t KernelArea, std::size_t StrideArea, bool CeilMode, bool Remains,
          std::size_t KernelRows, std::size_t KernelColumns, std::size_t MostRowsOfPadding,
          std::size_t MostColumnsOfPadding>
[[nodiscard]] constexpr shape transposed_conv2d_output(const sliding_window& window) {
    static_assert(Filters > 0 && KernelArea > 0 && StrideArea > 0,
                  "transposed_conv2d: filters, kernel and stride must be at least 1");
    static_assert(!CeilMode, "transposed_conv2d: ceil_mode has no meaning here; give the padding with pad");
    static_assert(padding_below_kernel<KernelRows, KernelColumns, MostRowsOfPadding, MostColumnsOfPadding>,
                  "transposed_conv2d: the padding must be smaller than the kernel; padding_below_kernel "
                  "shows kernel rows, kernel columns, rows and columns of padding on one side");
    static_assert(KernelArea == 0 || Remains, "transposed_conv2d: the padding leaves no row or no column");
    return window.input;
}

} // namespace detail

/// Transposed convolution, which enlarges a map: each pixel adds its multiple of the kernel to the output, at
/// distances of the stride. PyTorch's ConvTranspose2d with one group, and its layout of weights: [channel of
/// the input][filter][row][column]. `padding::same` gives size × stride outputs; `padding::valid` and `pad`
/// crop an output of (size − 1) × stride + kernel, on each side by less than the kernel. PyTorch's padding p
/// and output_padding o are pad(p, p − o, p, p − o). Filters, kernel and stride are at least 1.
template <std::size_t Filters, extent2d Kernel, extent2d Stride = Kernel, padding Padding = padding::same,
          bool Bias = true>
struct transposed_conv2d {
    static constexpr std::string_view name = "conv";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        const auto window = window_for(input);
        const std::size_t weights = input.channels * Filters * Kernel.area();
        return {.output = window.input,
                .parameters = weights + (Bias ? Filters : 0),
                .multiply_adds = input.area() * weights,
                .multiply_adds_on_pixels = window.taps_on_pixels() * input.channels * Filters};
    }

private:
    static constexpr sliding_window window_for(const shape& input) {
        return detail::transposed_window(input, Filters, Kernel, Stride, Padding);
    }

public:
    template <class T, shape Input>
    struct layer : layer_base<T, Input, transposed_conv2d> {
        static constexpr bool has_bias = Bias;
        static constexpr sliding_window window = window_for(Input);
        static constexpr shape output = detail::transposed_conv2d_output<
            Filters, Kernel.area(), Stride.area(), Padding.how == padding::rule::ceil_mode,
            (detail::uncropped(Input.rows, Kernel.rows, Stride.rows) > Padding.top + Padding.bottom &&
             detail::uncropped(Input.columns, Kernel.columns, Stride.columns) > Padding.left + Padding.right),
            Kernel.rows, Kernel.columns, std::max(window.top, window.bottom),
            std::max(window.left, window.right)>(window);
        static constexpr std::size_t weights = layer::parameters - (Bias ? Filters : 0);

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            // Inputs of one output as PyTorch counts them for its initialisation.
            describe_array(list, prefix, "weight", parameter_role::weight,
                           {Input.channels, Filters, Kernel.rows, Kernel.columns}, 0,
                           Filters * Kernel.area());
            if constexpr (Bias)
                describe_array(list, prefix, "bias", parameter_role::bias, {Filters}, weights);
        }
    };
};

}} // namespace tactnet
