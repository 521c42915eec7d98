#pragma once

#include <tactnet/kernels/batch/pooling.hpp>
#include <tactnet/layers/layer.hpp>
#include <tactnet/layers/pool_window.hpp>

#include <cstddef>
#include <string_view>

namespace tactnet {
inline namespace TACTNET_ARCH {

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

} // namespace TACTNET_ARCH
} // namespace tactnet
