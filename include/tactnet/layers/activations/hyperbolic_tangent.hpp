#pragma once

#include <tactnet/kernels/simd/special_functions.hpp>
#include <tactnet/layers/activation_function.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

/// tanh x, within 2 units in the last place.
struct hyperbolic_tangent_function {
    static constexpr const char *name = "tanh", *title = "Hyperbolic tangent",
                                *type = "tactnet::hyperbolic_tangent_function",
                                *header = "tactnet/layers/activations/hyperbolic_tangent.hpp";
    static constexpr bool takes_vectors = true;

    template <class Number>
    static constexpr Number value(const Number& x) {
        return kernels::hyperbolic_tangent(x);
    }
    template <class Number>
    static constexpr Number backward(const Number& y, const Number& gradient) {
        return gradient * ((Number(1) - y) * (Number(1) + y));
    }
};

using hyperbolic_tangent = activation<hyperbolic_tangent_function>;

}} // namespace tactnet
