#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/operators/activations/function.hpp>
#include <tactnet/operators/layer.hpp>

#include <cstddef>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The elementwise layer of an activation function, in place unless its gradient needs the input.
/// `activation_function.hpp` shows how to write one.
template <activation_function Function>
struct activation {
    static constexpr std::string_view name = Function::name;
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        constexpr bool from_output = !detail::needs_input<Function>;
        return {.output = input, .in_place = from_output, .keeps_output = from_output};
    }

    template <class T, shape Input>
    struct layer : lane_block_layer<T, Input, activation> {
        static constexpr std::size_t elements = Input.size() * kernels::lanes<T>;

        static void forward_block(const T* in, T* out) {
            if constexpr (detail::is_relu<Function>())
                kernels::relu_forward(in, out, elements);
            else
                detail::transform<Function>([](auto x) { return Function::value(x); }, elements, out, in);
        }
        static void backward_block(const T* in, const T* out, const T* out_gradient, T* in_gradient) {
            if constexpr (detail::is_relu<Function>())
                kernels::relu_backward(out, out_gradient, in_gradient, elements);
            else if constexpr (detail::needs_input<Function>)
                detail::transform<Function>(
                    [](auto x, auto g) { return Function::backward_from_input(x, g); }, elements, in_gradient,
                    in, out_gradient);
            else
                detail::transform<Function>([](auto y, auto g) { return Function::backward(y, g); }, elements,
                                            in_gradient, out, out_gradient);
        }
    };
};

/// Rectified linear unit: max(x, 0). In place.
using relu = activation<relu_function>;

}} // namespace tactnet
