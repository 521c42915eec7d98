#pragma once

#include <tactnet/kernels/batch/pooling.hpp>
#include <tactnet/layers/layer.hpp>
#include <tactnet/layers/pool_window.hpp>

#include <cstddef>
#include <string_view>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Max pooling. `same` padding gives ceil(size / stride) outputs; padding is never looked at.
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
        // By the window, which refuses an input that it does not fit.
        static constexpr shape output{window.output_rows(), window.output_columns(), Input.channels};
        static constexpr bool by_parts = true;

        static void infer(const execution_context& p, const T*, const T*, no_memory&, input_view<T, Input> in,
                          output_view<T, output> out) {
            p.threads.for_each(in.lane_blocks(), [&](std::size_t g) {
                kernels::max_pool_forward<window>(in.lane_block(g), out.lane_block(g));
            });
        }
        static void forward(const execution_context& p, const T* none, T*, no_memory& m,
                            input_view<T, Input> in, output_view<T, output> out) {
            infer(p, none, none, m, in, out);
        }
        static void backward(const execution_context& p, const T*, no_memory&, input_view<T, Input> in,
                             input_view<T, output> out, input_view<T, output> out_gradient,
                             output_view<T, Input> in_gradient, T*) {
            if (in_gradient.data() == nullptr)
                return;
            p.threads.for_each(in.lane_blocks(), [&](std::size_t g) {
                kernels::max_pool_backward<window>(in.lane_block(g), out.lane_block(g),
                                                   out_gradient.lane_block(g), in_gradient.lane_block(g));
            });
        }
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet
