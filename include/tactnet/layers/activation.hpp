#pragma once

#include <tactnet/layers/activation_function.hpp>
#include <tactnet/layers/layer.hpp>

#include <cstddef>
#include <string_view>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The elementwise layer of an activation function, in place. `activation_function.hpp` shows how to write
/// one.
template <activation_function Function>
struct activation {
    using function = Function; ///< for deployment
    static constexpr std::string_view name = Function::name;
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, activation> {
        static constexpr bool by_parts = true;

        static void infer(const execution_context& p, const T*, const T*, no_memory&, input_view<T, Input> in,
                          output_view<T, Input> out) {
            p.threads.for_each(in.lane_blocks(), [&](std::size_t block) {
                const T* const x = in.lane_block(block);
                T* const y = out.lane_block(block);
                for (std::size_t e = 0; e < in.lane_block_size; ++e)
                    y[e] = Function::value(x[e]);
            });
        }
        static void forward(const execution_context& p, const T* none, T*, no_memory& memory,
                            input_view<T, Input> in, output_view<T, Input> out) {
            infer(p, none, none, memory, in, out);
        }
        static void backward(const execution_context& p, const T*, no_memory&, input_view<T, Input>,
                             input_view<T, Input> out, input_view<T, Input> out_gradient,
                             output_view<T, Input> in_gradient, T*) {
            if (in_gradient.data() == nullptr)
                return;
            p.threads.for_each(out.lane_blocks(), [&](std::size_t block) {
                const T *const y = out.lane_block(block), *const gradient = out_gradient.lane_block(block);
                T* const to = in_gradient.lane_block(block);
                for (std::size_t e = 0; e < out.lane_block_size; ++e)
                    to[e] = Function::backward(y[e], gradient[e]);
            });
        }
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet
