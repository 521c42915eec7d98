#pragma once

#include <tactnet/kernels/batch/pooling.hpp>
#include <tactnet/layers/layer.hpp>

#include <algorithm>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <std::size_t WindowRows, std::size_t WindowColumns, std::size_t PaddedRows,
          std::size_t PaddedColumns>
concept window_fits_padded_input = (WindowRows <= PaddedRows) && (WindowColumns <= PaddedColumns);

template <std::size_t PaddingRows, std::size_t PaddingColumns, std::size_t WindowRows,
          std::size_t WindowColumns>
concept every_window_holds_a_pixel = (PaddingRows < WindowRows) && (PaddingColumns < WindowColumns);

namespace detail {

template <std::size_t WindowRows, std::size_t WindowColumns, std::size_t StrideArea, std::size_t PaddedRows,
          std::size_t PaddedColumns, std::size_t MostRowsOfPadding, std::size_t MostColumnsOfPadding>
[[nodiscard]] constexpr shape max_pool_output(shape output) {
    static_assert(WindowRows > 0 && WindowColumns > 0 && StrideArea > 0,
                  "max_pool: window and stride must be at least 1");
    static_assert(
        window_fits_padded_input<WindowRows, WindowColumns, PaddedRows, PaddedColumns>,
        "max_pool: the window is larger than the padded input; window_fits_padded_input shows window rows, "
        "window columns, padded rows, padded columns");
    static_assert(
        every_window_holds_a_pixel<MostRowsOfPadding, MostColumnsOfPadding, WindowRows, WindowColumns>,
        "max_pool: the padding must be smaller than the window, or a window holds no pixel; "
        "every_window_holds_a_pixel shows rows and columns of padding on one side, window rows, window "
        "columns");
    return output;
}

} // namespace detail

/// Max pooling. `same` padding gives ceil(size / stride) outputs; padding is never looked at.
template <extent Window, extent Stride = Window, padding Padding = same>
struct max_pool {
    static constexpr std::string_view name = "pool";
    static constexpr bool numbered = true;

    template <class T, shape Input>
    struct layer : layer_without_parameters<T, Input, shape{}> {
        static constexpr sliding_window window = sliding_window::over(Input, Window, Stride, Padding);
        static constexpr shape output =
            detail::max_pool_output<Window.rows, Window.columns, Stride.area(),
                                    Input.rows + window.top + window.bottom,
                                    Input.columns + window.left + window.right,
                                    std::max(window.top, window.bottom), std::max(window.left, window.right)>(
                {window.output_rows(), window.output_columns(), Input.channels});
        static constexpr bool keeps_output = true, by_parts = true;

        static void infer(const pass& p, const T*, const T*, no_memory&, input_view<T, Input> in,
                          output_view<T, output> out) {
            p.threads.for_each(in.groups(), [&](std::size_t g) {
                kernels::max_pool_forward<window>(in.group(g), out.group(g));
            });
        }
        static void forward(const pass& p, const T* none, T*, no_memory& m, input_view<T, Input> in,
                            output_view<T, output> out) {
            infer(p, none, none, m, in, out);
        }
        static void backward(const pass& p, const T*, no_memory&, input_view<T, Input> in,
                             input_view<T, output> out, input_view<T, output> out_gradient,
                             output_view<T, Input> in_gradient, T*) {
            if (in_gradient.data() == nullptr)
                return;
            p.threads.for_each(in.groups(), [&](std::size_t g) {
                kernels::max_pool_backward<window>(in.group(g), out.group(g), out_gradient.group(g),
                                                   in_gradient.group(g));
            });
        }
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet
