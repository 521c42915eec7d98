#pragma once

#include <tactnet/kernels/batch/elementwise.hpp>
#include <tactnet/layers/layer.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Rectified linear unit: max(x, 0). In place.
struct relu {
    static constexpr std::string_view name = "relu";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, relu> {
        static constexpr bool by_parts = true;

        static void infer(const pass& p, const T*, const T*, no_memory&, input_view<T, Input> in,
                          output_view<T, Input> out) {
            p.threads.for_each(in.groups(), [&](std::size_t g) {
                kernels::relu_forward(in.group(g), out.group(g), in.group_size);
            });
        }
        static void forward(const pass& p, const T* none, T*, no_memory& m, input_view<T, Input> in,
                            output_view<T, Input> out) {
            infer(p, none, none, m, in, out);
        }
        static void backward(const pass& p, const T*, no_memory&, input_view<T, Input>,
                             input_view<T, Input> out, input_view<T, Input> out_gradient,
                             output_view<T, Input> in_gradient, T*) {
            if (in_gradient.data() == nullptr)
                return;
            p.threads.for_each(out.groups(), [&](std::size_t g) {
                kernels::relu_backward(out.group(g), out_gradient.group(g), in_gradient.group(g),
                                       out.group_size);
            });
        }
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet
