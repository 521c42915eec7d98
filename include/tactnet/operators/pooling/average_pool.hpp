#pragma once

#include <tactnet/kernels/batch/pooling.hpp>
#include <tactnet/operators/layer.hpp>
#include <tactnet/operators/pooling/max_pool.hpp>

#include <cstddef>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

/// What the sum of a window is divided by: the pixels in it, or the zeros around them as well (PyTorch's
/// count_include_pad).
enum class average_over { pixels, pixels_and_padding };

namespace detail {

/// Averages over given windows.
template <class Spec, class T, shape Input, pooling_windows Windows>
struct average_layer : lane_block_layer<T, Input, Spec> {
    static constexpr pooling_windows windows = Windows;

    static void forward_block(const T* in, T* out) {
        kernels::average_pool_forward(windows, Input.channels, in, out);
    }
    static void backward_block(const T*, const T*, const T* out_gradient, T* in_gradient) {
        kernels::average_pool_backward(windows, Input.channels, out_gradient, in_gradient);
    }
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

}} // namespace tactnet
