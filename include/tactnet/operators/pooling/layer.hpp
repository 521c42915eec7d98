#pragma once

#include <tactnet/kernels/sampling_axis.hpp>
#include <tactnet/operators/layer.hpp>
#include <tactnet/tensor/pooling_windows.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t WindowRows, std::size_t WindowColumns, std::size_t PaddedRows,
          std::size_t PaddedColumns>
concept window_fits_padded_input = (WindowRows <= PaddedRows) && (WindowColumns <= PaddedColumns);

template <std::size_t PaddingRows, std::size_t PaddingColumns, std::size_t WindowRows,
          std::size_t WindowColumns>
concept every_window_holds_a_pixel = (PaddingRows < WindowRows) && (PaddingColumns < WindowColumns);

namespace detail {

/// A function of numbers, so that compilers show them.
template <std::size_t WindowRows, std::size_t WindowColumns, std::size_t StrideArea, std::size_t PaddedRows,
          std::size_t PaddedColumns, std::size_t MostRowsOfPadding, std::size_t MostColumnsOfPadding>
[[nodiscard]] constexpr sliding_window checked_pool_window(const sliding_window& window) {
    static_assert(WindowRows > 0 && WindowColumns > 0 && StrideArea > 0,
                  "pool: window and stride must be at least 1");
    static_assert(
        window_fits_padded_input<WindowRows, WindowColumns, PaddedRows, PaddedColumns>,
        "pool: the window is larger than the padded input; window_fits_padded_input shows window rows, "
        "window columns, padded rows, padded columns");
    static_assert(
        every_window_holds_a_pixel<MostRowsOfPadding, MostColumnsOfPadding, WindowRows, WindowColumns>,
        "pool: the padding must be smaller than the window, or a window holds no pixel; "
        "every_window_holds_a_pixel shows rows and columns of padding on one side, window rows, window "
        "columns");
    return window;
}

/// Where the window of a pool goes. One that does not fit, or may see nothing but padding, is refused.
template <shape Input, extent2d Window, extent2d Stride, padding Padding>
[[nodiscard]] constexpr sliding_window pool_window() {
    constexpr sliding_window w = sliding_window::over(Input, Window, Stride, Padding);
    return checked_pool_window<Window.rows, Window.columns, Stride.area(), Input.rows + w.top + w.bottom,
                               Input.columns + w.left + w.right, std::max(w.top, w.bottom),
                               std::max(w.left, w.right)>(w);
}

} // namespace detail

/// Max pooling. `padding::same` gives ceil(size / stride) outputs; padding is ignored.
template <extent2d Window, extent2d Stride = Window, padding Padding = padding::same>
struct max_pool {
    static constexpr std::string_view name = "pool";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        const auto window = sliding_window::over(input, Window, Stride, Padding);
        return {.output = {window.output_rows(), window.output_columns(), input.channels},
                .keeps_output = true};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, max_pool> {
        static constexpr sliding_window window = detail::pool_window<Input, Window, Stride, Padding>();
        // Depends on the window, which rejects an input that it does not fit.
        static constexpr shape output{window.output_rows(), window.output_columns(), Input.channels};
    };
};

/// The largest value of each channel.
struct global_max_pool {
    static constexpr std::string_view name = "pool";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = {1, 1, input.channels}, .keeps_output = true};
    }

    template <class T, shape Input>
    using layer =
        typename max_pool<extent2d(Input.rows, Input.columns), 1, padding::valid>::template layer<T, Input>;
};

namespace detail {

template <std::size_t Rows, std::size_t Columns>
[[nodiscard]] constexpr shape adaptive_max_output(std::size_t channels) {
    static_assert(Rows > 0 && Columns > 0, "adaptive_max_pool: there must be at least one output");
    return {Rows, Columns, channels};
}

} // namespace detail

/// Max pooling to a map of a given size from any input, with bins as equal as possible, which may overlap:
/// PyTorch's AdaptiveMaxPool2d. The largest value of each bin; NaN wins. An output of more rows or columns
/// than the input repeats pixels. `Output` has at least one row and one column.
template <extent2d Output>
struct adaptive_max_pool {
    static constexpr std::string_view name = "pool";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = {Output.rows, Output.columns, input.channels}, .keeps_output = true};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, adaptive_max_pool> {
        static constexpr shape output =
            detail::adaptive_max_output<Output.rows, Output.columns>(Input.channels);
        static constexpr pooling_windows windows{.rows = {Input.rows, Output.rows},
                                                 .columns = {Input.columns, Output.columns}};
        /// Whether the bins are the windows of a max pool, side by side.
        static constexpr bool equal_bins =
            Input.rows % output.rows == 0 && Input.columns % output.columns == 0;
    };
};

/// What the sum of a window is divided by: the pixels in it, or the zeros around them as well (PyTorch's
/// count_include_pad).
enum class average_over { pixels, pixels_and_padding };

namespace detail {

/// Averages over given windows.
template <class Spec, class T, shape Input, pooling_windows Windows>
struct average_layer : layer_base<T, Input, Spec> {
    static constexpr pooling_windows windows = Windows;
};

/// The windows of PyTorch: what ceil mode adds after the given padding does not count as padding.
[[nodiscard]] constexpr pooling_windows average_windows_of(const sliding_window& w, padding given,
                                                           average_over over) {
    const bool completed = given.how == padding::rule::ceil_mode;
    return {.rows = {w.input.rows, w.output_rows(), w.kernel.rows, w.stride.rows, w.top,
                     completed ? given.bottom : w.bottom},
            .columns = {w.input.columns, w.output_columns(), w.kernel.columns, w.stride.columns, w.left,
                        completed ? given.right : w.right},
            .counts_padding = over == average_over::pixels_and_padding};
}

template <std::size_t Rows, std::size_t Columns>
[[nodiscard]] constexpr pooling_windows adaptive_windows(shape input) {
    static_assert(Rows > 0 && Columns > 0, "adaptive_average_pool: there must be at least one output");
    return {.rows = {input.rows, Rows}, .columns = {input.columns, Columns}};
}

} // namespace detail

/// Average pooling. `padding::same` gives ceil(size / stride) outputs.
template <extent2d Window, extent2d Stride = Window, padding Padding = padding::same,
          average_over Over = average_over::pixels>
struct average_pool {
    static constexpr std::string_view name = "pool";
    static constexpr bool numbered = true;

    template <class T, shape Input>
    static constexpr sliding_window window = detail::pool_window<Input, Window, Stride, Padding>();
    static constexpr layer_costs costs(const shape& input) {
        const auto windows = sliding_window::over(input, Window, Stride, Padding);
        return {.output = {windows.output_rows(), windows.output_columns(), input.channels}};
    }

    template <class T, shape Input>
    using layer = detail::average_layer<average_pool, T, Input,
                                        detail::average_windows_of(window<T, Input>, Padding, Over)>;
};

/// Average pooling to a map of a given size from any input, with bins as equal as possible: PyTorch's
/// AdaptiveAvgPool2d, which also enlarges.
template <extent2d Output>
struct adaptive_average_pool {
    static constexpr std::string_view name = "pool";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = {Output.rows, Output.columns, input.channels}};
    }

    template <class T, shape Input>
    using layer = detail::average_layer<adaptive_average_pool, T, Input,
                                        detail::adaptive_windows<Output.rows, Output.columns>(Input)>;
};

/// The mean of each channel (Lin, Chen, Yan, "Network in network", 2014).
using global_average_pool = adaptive_average_pool<1>;

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
