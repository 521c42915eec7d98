#pragma once

#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

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
} // namespace TACTNET_ARCH
} // namespace tactnet
