#pragma once

#include <tactnet/kernels/batch/pooling.hpp>
#include <tactnet/operators/layer.hpp>
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
    struct layer : lane_block_layer<T, Input, max_pool> {
        static constexpr sliding_window window = detail::pool_window<Input, Window, Stride, Padding>();
        // Depends on the window, which rejects an input that it does not fit.
        static constexpr shape output{window.output_rows(), window.output_columns(), Input.channels};

        static void forward_block(const T* in, T* out) { kernels::max_pool_forward<window>(in, out); }
        static void backward_block(const T* in, const T* out, const T* out_gradient, T* in_gradient) {
            kernels::max_pool_backward<window>(in, out, out_gradient, in_gradient);
        }
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

}} // namespace tactnet
