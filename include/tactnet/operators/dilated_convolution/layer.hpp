#pragma once

#include <tactnet/kernels/dilated_axis.hpp>
#include <tactnet/operators/convolution/layer.hpp>
#include <tactnet/operators/layer.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <std::size_t DilationArea, std::size_t ReachRows, std::size_t ReachColumns, std::size_t PaddedRows,
          std::size_t PaddedColumns>
[[nodiscard]] constexpr shape dilated_conv2d_output(shape output) {
    static_assert(DilationArea > 0, "dilated_conv2d: the dilation must be at least 1");
    static_assert(kernel_fits_padded_input<ReachRows, ReachColumns, PaddedRows, PaddedColumns>,
                  "dilated_conv2d: the dilated kernel is larger than the padded input; "
                  "kernel_fits_padded_input shows its rows, its columns, padded rows, padded columns");
    return output;
}

} // namespace detail

/// Convolution whose taps are `Dilation` pixels apart: it sees a larger part of the map with the same weights
/// (Yu, Koltun, "Multi-scale context aggregation by dilated convolutions", 2016). PyTorch's
/// Conv2d(dilation=…). `padding::same` pads for the dilated kernel, whose size is (kernel − 1) × dilation
/// + 1. Everything else is as for conv2d.
template <std::size_t Filters, extent2d Kernel, extent2d Dilation = 2, extent2d Stride = 1,
          padding Padding = padding::same, conv2d_options Options = conv2d_options{}>
struct dilated_conv2d {
    static constexpr std::string_view name = "conv";
    static constexpr bool numbered = true;

private:
    /// The layer rejects zeros.
    static constexpr extent2d at_least_one(extent2d e) {
        return {e.rows > 0 ? e.rows : 1, e.columns > 0 ? e.columns : 1};
    }

public:
    static constexpr extent2d kernel = at_least_one(Kernel), dilation = at_least_one(Dilation);

    static constexpr layer_costs costs(const shape& input) {
        const sliding_window w = reach_over(input);
        const std::size_t rows = w.output_rows(), columns = w.output_columns();
        layer_costs found = conv2d<Filters, kernel, 1, padding::same, Options>::costs(input);
        const std::size_t of_tap =
            (found.parameters - (Options.bias ? Filters : 0)) / kernel.area(); // filters × channels
        const auto down = kernels::dilated_axis::of(input.rows, rows, kernel.rows, dilation.rows,
                                                    w.stride.rows, w.top),
                   along = kernels::dilated_axis::of(input.columns, columns, kernel.columns, dilation.columns,
                                                     w.stride.columns, w.left);
        found.output = {rows, columns, Filters};
        found.multiply_adds = rows * columns * kernel.area() * of_tap;
        found.multiply_adds_on_pixels = down.taps_on_pixels() * along.taps_on_pixels() * of_tap;
        return found;
    }

private:
    static constexpr sliding_window reach_over(const shape& input) {
        return sliding_window::over(
            input, {(kernel.rows - 1) * dilation.rows + 1, (kernel.columns - 1) * dilation.columns + 1},
            Stride, Padding);
    }

public:
    template <class T, shape Input>
    struct layer : layer_base<T, Input, dilated_conv2d> {
    private:
        static constexpr sliding_window reach = reach_over(Input);
        template <class Phases>
        using spec_of = conv2d<Filters, kernel, Phases::window.stride, Phases::around, Options>;

    public:
        static constexpr shape output = detail::dilated_conv2d_output<
            Dilation.area(), reach.kernel.rows, reach.kernel.columns, Input.rows + reach.top + reach.bottom,
            Input.columns + reach.left + reach.right>(
            // Everything but the size of the kernel.
            detail::conv2d_output<Filters, Kernel.area(), Stride.area(), 1, 1, 1, 1, Options.groups,
                                  Input.channels>({reach.output_rows(), reach.output_columns(), Filters}));
        static constexpr extent2d dilation = dilated_conv2d::dilation;
        /// With the padding of the dilated kernel.
        static constexpr sliding_window window{Input,        kernel,     reach.stride, reach.top,
                                               reach.bottom, reach.left, reach.right};
        static constexpr extent2d outputs{output.rows, output.columns};
        /// In training one phase of the rows lies below the other: a weight gradient by tiles needs short
        /// rows of tiles.
        using phases = kernels::laid_out_phases<kernels::dilated_layout::of(
            window, dilation, outputs, kernels::phase_order::consecutive)>;
        using deployed_phases = kernels::dilated_phases<window, dilation, outputs>;
        /// The convolution of the phases, in training and deployed.
        using convolution_spec = spec_of<phases>;
        using convolution = typename convolution_spec::template layer<T, phases::map>;
        using deployed_convolution =
            typename spec_of<deployed_phases>::template layer<T, deployed_phases::map>;

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            convolution::describe(prefix, list);
        }
    };
};

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
