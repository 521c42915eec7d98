#pragma once

#include <tactnet/kernels/elementwise.hpp>
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
    static constexpr std::string_view name = Function::name;
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    template <class T, shape Input>
    struct layer : lane_block_layer<T, Input, activation> {
        static constexpr std::size_t elements = Input.size() * kernels::lanes<T>;

        static void forward_block(const T* in, T* out) {
            for (std::size_t e = 0; e < elements; ++e)
                out[e] = Function::value(in[e]);
        }
        static void backward_block(const T*, const T* out, const T* out_gradient, T* in_gradient) {
            for (std::size_t e = 0; e < elements; ++e)
                in_gradient[e] = Function::backward(out[e], out_gradient[e]);
        }
    };
};

/// Rectified linear unit: max(x, 0). In place.
struct relu {
    static constexpr std::string_view name = "relu";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    template <class T, shape Input>
    struct layer : lane_block_layer<T, Input, relu> {
        static constexpr std::size_t elements = Input.size() * kernels::lanes<T>;

        static void forward_block(const T* in, T* out) { kernels::relu_forward(in, out, elements); }
        static void backward_block(const T*, const T* out, const T* out_gradient, T* in_gradient) {
            kernels::relu_backward(out, out_gradient, in_gradient, elements);
        }
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet
