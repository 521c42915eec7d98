#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/layers/activation_function.hpp>
#include <tactnet/layers/layer.hpp>

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The elementwise layer of an activation function, in place. `activation_function.hpp` shows how to write
/// one.
template <activation_function Function>
struct activation {
    static constexpr std::string_view name = Function::name;
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    template <class T, shape Input>
    struct layer : lane_block_layer<T, Input, activation> {
        static constexpr std::size_t elements = Input.size() * kernels::lanes<T>;

        static void forward_block(const T* in, T* out) {
            if constexpr (detail::is_relu<Function>())
                kernels::relu_forward(in, out, elements);
            else
                std::transform(in, in + elements, out, [](T x) { return Function::value(x); });
        }
        static void backward_block(const T*, const T* out, const T* out_gradient, T* in_gradient) {
            if constexpr (detail::is_relu<Function>())
                kernels::relu_backward(out, out_gradient, in_gradient, elements);
            else
                std::transform(out, out + elements, out_gradient, in_gradient,
                               [](T y, T gradient) { return Function::backward(y, gradient); });
        }
    };
};

/// Rectified linear unit: max(x, 0). In place.
using relu = activation<relu_function>;

}} // namespace tactnet
