#pragma once

#include <tactnet/operators/layer.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t KernelRows, std::size_t KernelColumns, std::size_t PaddedRows,
          std::size_t PaddedColumns>
concept kernel_fits_padded_input = (KernelRows <= PaddedRows) && (KernelColumns <= PaddedColumns);

template <std::size_t Groups, std::size_t Channels, std::size_t Filters>
concept groups_divide = (Groups > 0) && (Channels % Groups == 0) && (Filters % Groups == 0);

/// Options of a convolution besides its window.
struct conv2d_options {
    std::size_t groups = 1; ///< the filters of a group see its channels only
    bool bias = true;

    friend constexpr bool operator==(const conv2d_options&, const conv2d_options&) = default;
};

/// Grouped convolution, as in AlexNet (Krizhevsky, Sutskever, Hinton, 2012). With as many groups as channels
/// it is depthwise.
[[nodiscard]] constexpr conv2d_options in_groups(std::size_t count) {
    return {.groups = count};
}
/// For convolutions before a batch norm, which has a bias of its own.
inline constexpr conv2d_options without_bias{.bias = false};

namespace detail {

template <std::size_t Filters, std::size_t KernelArea, std::size_t StrideArea, std::size_t KernelRows,
          std::size_t KernelColumns, std::size_t PaddedRows, std::size_t PaddedColumns, std::size_t Groups,
          std::size_t Channels>
[[nodiscard]] constexpr shape conv2d_output(shape output) {
    static_assert(groups_divide<Groups, Channels, Filters>,
                  "conv2d: groups must divide the channels of the input and the filters; groups_divide shows "
                  "groups, channels, filters");
    static_assert(Filters > 0 && KernelArea > 0 && StrideArea > 0,
                  "conv2d: filters, kernel and stride must be at least 1");
    static_assert(
        kernel_fits_padded_input<KernelRows, KernelColumns, PaddedRows, PaddedColumns>,
        "conv2d: the kernel is larger than the padded input; kernel_fits_padded_input shows kernel rows, "
        "kernel columns, padded rows, padded columns");
    return output;
}

} // namespace detail

/// Two-dimensional convolution (cross-correlation), with bias unless the options leave it out.
/// Weights are [filter][channel][row][column] (PyTorch's OIHW), the channels those of the filter's group.
template <std::size_t Filters, extent2d Kernel, extent2d Stride = 1, padding Padding = padding::same,
          conv2d_options Options = conv2d_options{}>
struct conv2d {
    static constexpr std::string_view name = "conv";
    static constexpr bool numbered = true;

    /// The layer rejects zero groups.
    static constexpr std::size_t groups = Options.groups > 0 ? Options.groups : 1;

    static constexpr layer_costs costs(const shape& input) {
        const auto window = sliding_window::over(input, Kernel, Stride, Padding);
        const shape output{window.output_rows(), window.output_columns(), Filters};
        const std::size_t channels = input.channels / groups;
        const std::size_t weights = Filters * channels * Kernel.area();
        return {.output = output,
                .parameters = weights + (Options.bias ? Filters : 0),
                .multiply_adds = output.area() * weights,
                .multiply_adds_on_pixels = window.taps_on_pixels() * channels * Filters};
    }

private:
    static constexpr sliding_window window_over(const shape& input) {
        return sliding_window::over(input, Kernel, Stride, Padding);
    }

public:
    template <class T, shape Input>
    struct layer : layer_base<T, Input, conv2d> {
        static constexpr sliding_window window = window_over(Input);
        static constexpr shape output =
            detail::conv2d_output<Filters, Kernel.area(), Stride.area(), Kernel.rows, Kernel.columns,
                                  Input.rows + window.top + window.bottom,
                                  Input.columns + window.left + window.right, Options.groups, Input.channels>(
                {window.output_rows(), window.output_columns(), Filters});
        static constexpr std::size_t groups = conv2d::groups;
        static constexpr bool has_bias = Options.bias;
        /// In one group.
        static constexpr std::size_t channels = Input.channels / groups, filters = Filters / groups;
        static constexpr std::size_t fan_in = channels * Kernel.area();
        static constexpr std::size_t weights = layer::parameters - (has_bias ? Filters : 0);

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "weight", parameter_role::weight,
                           {Filters, channels, Kernel.rows, Kernel.columns}, 0, fan_in);
            if constexpr (Options.bias)
                describe_array(list, prefix, "bias", parameter_role::bias, {Filters}, weights);
        }
    };
};

}} // namespace tactnet
