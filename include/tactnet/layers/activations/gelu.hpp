#pragma once

#include <tactnet/kernels/simd/special_functions.hpp>
#include <tactnet/layers/activation_function.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

/// x · Φ(x), where Φ is the standard normal distribution (Hendrycks, Gimpel, "Gaussian error linear units",
/// 2016): PyTorch's GELU without approximation. Within 10 units in the last place; 0 below −13.2.
struct gelu_function {
    static constexpr const char *name = "gelu", *title = "GELU", *type = "tactnet::gelu_function",
                                *header = "tactnet/layers/activations/gelu.hpp";
    static constexpr bool takes_vectors = true;

    template <class Number>
    static constexpr Number value(const Number& x) {
        return x * distribution(x);
    }
    /// Φ(x) + x · φ(x), where φ is the density.
    template <class Number>
    static constexpr Number backward_from_input(const Number& x, const Number& gradient) {
        return gradient * (distribution(x) + x * kernels::normal_density(x));
    }

private:
    template <class Number>
    static constexpr Number distribution(const Number& x) {
        const Number tail = kernels::normal_tail(kernels::magnitude(x));
        return kernels::choose_lanes(x < Number(0), tail, Number(1) - tail);
    }
};

using gelu = activation<gelu_function>;

}} // namespace tactnet
