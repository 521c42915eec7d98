#pragma once

#include <tactnet/kernels/simd/special_functions.hpp>
#include <tactnet/layers/activation_function.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

/// 1 ÷ (1 + e⁻ˣ), within 4 units in the last place; 0 below −87.3.
struct sigmoid_function {
    static constexpr const char *name = "sigmoid", *title = "Sigmoid", *type = "tactnet::sigmoid_function",
                                *header = "tactnet/layers/activations/sigmoid.hpp";
    static constexpr bool takes_vectors = true, moves_zero = true;

    /// By e to the power of −|x|, which does not overflow.
    template <class Number>
    static constexpr Number value(const Number& x) {
        const Number power = kernels::exponential(Number(0) - kernels::magnitude(x));
        const Number upper = Number(1) / (Number(1) + power);
        return kernels::choose_lanes(x < Number(0), power * upper, upper);
    }
    template <class Number>
    static constexpr Number backward(const Number& y, const Number& gradient) {
        return gradient * (y * (Number(1) - y));
    }
};

/// x · sigmoid(x), also known as swish (Elfwing, Uchibe, Doya, "Sigmoid-weighted linear units", 2018), within
/// 5 units in the last place; 0 below −87.3.
struct silu_function {
    static constexpr const char *name = "silu", *title = "SiLU", *type = "tactnet::silu_function",
                                *header = "tactnet/layers/activations/sigmoid.hpp";
    static constexpr bool takes_vectors = true;

    template <class Number>
    static constexpr Number value(const Number& x) {
        return x * sigmoid_function::value(x);
    }
    /// σ(x) · (1 + x · σ(−x)): the difference 1 − σ(x) would cancel.
    template <class Number>
    static constexpr Number backward_from_input(const Number& x, const Number& gradient) {
        const Number share = sigmoid_function::value(x), rest = sigmoid_function::value(Number(0) - x);
        return gradient * (share * (Number(1) + x * rest));
    }
};

using sigmoid = activation<sigmoid_function>;
using silu = activation<silu_function>;

}} // namespace tactnet
