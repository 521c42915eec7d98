#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/layers/activation_function.hpp>
#include <tactnet/layers/layer.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Rectified linear unit: max(x, 0). In place.
struct relu {
    using function = relu_function; ///< for deployment
    static constexpr std::string_view name = "relu";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, relu> {
        static constexpr bool by_parts = true;

        static void infer(const execution_context& p, const T*, const T*, no_memory&, input_view<T, Input> in,
                          output_view<T, Input> out) {
            p.threads.for_each(in.lane_blocks(), [&](std::size_t g) {
                kernels::relu_forward(in.lane_block(g), out.lane_block(g), in.lane_block_size);
            });
        }
        static void forward(const execution_context& p, const T* none, T*, no_memory& m,
                            input_view<T, Input> in, output_view<T, Input> out) {
            infer(p, none, none, m, in, out);
        }
        static void backward(const execution_context& p, const T*, no_memory&, input_view<T, Input>,
                             input_view<T, Input> out, input_view<T, Input> out_gradient,
                             output_view<T, Input> in_gradient, T*) {
            if (in_gradient.data() == nullptr)
                return;
            p.threads.for_each(out.lane_blocks(), [&](std::size_t g) {
                kernels::relu_backward(out.lane_block(g), out_gradient.lane_block(g),
                                       in_gradient.lane_block(g), out.lane_block_size);
            });
        }
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet
