#pragma once

#include <tactnet/kernels/batch/pooling.hpp>
#include <tactnet/operators/layer.hpp>
#include <tactnet/tensor/pooling_windows.hpp>

#include <cstddef>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

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
    struct layer : lane_block_layer<T, Input, adaptive_max_pool> {
        static constexpr shape output =
            detail::adaptive_max_output<Output.rows, Output.columns>(Input.channels);
        static constexpr pooling_windows windows{.rows = {Input.rows, Output.rows},
                                                 .columns = {Input.columns, Output.columns}};
        /// Whether the bins are the windows of a max pool, side by side.
        static constexpr bool equal_bins =
            Input.rows % output.rows == 0 && Input.columns % output.columns == 0;

        static void forward_block(const T* in, T* out) {
            kernels::max_pool_forward(windows, Input.channels, in, out);
        }
        static void backward_block(const T* in, const T* out, const T* out_gradient, T* in_gradient) {
            kernels::max_pool_backward(windows, Input.channels, in, out, out_gradient, in_gradient);
        }
    };
};

}} // namespace tactnet
