#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/operators/activations/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <class Function, class T, shape Input>
struct trained_layer<activation<Function>, T, Input> : lane_block_layer<activation<Function>, T, Input> {
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
            detail::transform<Function>([](auto x, auto g) { return Function::backward_from_input(x, g); },
                                        elements, in_gradient, in, out_gradient);
        else
            detail::transform<Function>([](auto y, auto g) { return Function::backward(y, g); }, elements,
                                        in_gradient, out, out_gradient);
    }
};

}} // namespace tactnet
