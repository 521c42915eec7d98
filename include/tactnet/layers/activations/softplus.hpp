#pragma once

#include <tactnet/kernels/simd/special_functions.hpp>
#include <tactnet/layers/activation_function.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

/// log(1 + eˣ), a smooth ReLU (Dugas et al., 2001), within 4 units in the last place; 0 below −87.3.
struct softplus_function {
    static constexpr const char *name = "softplus", *title = "Softplus", *type = "tactnet::softplus_function",
                                *header = "tactnet/layers/activations/softplus.hpp";
    static constexpr bool takes_vectors = true, moves_zero = true;

    /// max(x, 0) + log(1 + e to the power of −|x|), which does not overflow.
    template <class Number>
    static constexpr Number value(const Number& x) {
        const Number rest = kernels::log_one_plus(kernels::exponential(Number(0) - kernels::magnitude(x)));
        return kernels::choose_lanes(x < Number(0), rest, x + rest);
    }
    /// 1 − e to the power of −y, as tanh(y ÷ 2) · (1 + that power): the difference would cancel.
    template <class Number>
    static constexpr Number backward(const Number& y, const Number& gradient) {
        const Number half = kernels::hyperbolic_tangent(Number(0.5F) * y);
        return gradient * (half * (Number(1) + kernels::exponential(Number(0) - y)));
    }
};

using softplus = activation<softplus_function>;

}} // namespace tactnet
