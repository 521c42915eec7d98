#pragma once

#include <tactnet/kernels/simd/special_functions.hpp>
#include <tactnet/operators/activations/function.hpp>

#include <array>
#include <concepts>

// Activations with an exponential. Each is computed in vectors, and its error in single precision is bounded
// in units in the last place. At −∞, SiLU and GELU are NaN, as in PyTorch.

namespace tactnet { inline namespace TACTNET_ARCH {

/// 1 ÷ (1 + e⁻ˣ), within 3 units in the last place; 0 below −88.4.
struct sigmoid_function {
    static constexpr const char *name = "sigmoid", *title = "Sigmoid", *type = "tactnet::sigmoid_function",
                                *header = "tactnet/operators/activations/smooth.hpp";
    static constexpr bool works_on_vectors = true, moves_zero = true;
    static constexpr double largest_value = 1;

    template <class Number>
    static constexpr Number value(const Number& x) {
        return kernels::quotient<Number>(Number(1), kernels::one_plus_exponential_of_opposite(x));
    }
    template <class Number>
    static constexpr Number backward(const Number& y, const Number& gradient) {
        return gradient * (y * (Number(1) - y));
    }
};

/// x · sigmoid(x), also known as swish (Elfwing, Uchibe, Doya, "Sigmoid-weighted linear units", 2018), within
/// 3 units in the last place; 0 below −88.4.
struct silu_function {
    static constexpr const char *name = "silu", *title = "SiLU", *type = "tactnet::silu_function",
                                *header = "tactnet/operators/activations/smooth.hpp";
    static constexpr bool works_on_vectors = true;

    template <class Number>
    static constexpr Number value(const Number& x) {
        return kernels::quotient<Number>(x, kernels::one_plus_exponential_of_opposite(x));
    }
    /// σ(x) · (1 + x · σ(−x)): the difference 1 − σ(x) would cancel.
    template <class Number>
    static constexpr Number backward_from_input(const Number& x, const Number& gradient) {
        const Number share = sigmoid_function::value(x), rest = sigmoid_function::value(Number(0) - x);
        return gradient * (share * (Number(1) + x * rest));
    }
};

/// tanh x, within 2 units in the last place.
struct hyperbolic_tangent_function {
    static constexpr const char *name = "tanh", *title = "Hyperbolic tangent",
                                *type = "tactnet::hyperbolic_tangent_function",
                                *header = "tactnet/operators/activations/smooth.hpp";
    static constexpr bool works_on_vectors = true;
    static constexpr double largest_value = 1;

    template <class Number>
    static constexpr Number value(const Number& x) {
        return kernels::hyperbolic_tangent(x);
    }
    template <class Number>
    static constexpr Number backward(const Number& y, const Number& gradient) {
        return gradient * ((Number(1) - y) * (Number(1) + y));
    }
};

/// x above 0, otherwise α · (eˣ − 1), which tends to −α (Clevert, Unterthiner, Hochreiter, "Fast and accurate
/// deep network learning by exponential linear units", 2016), within 3 units in the last place. α is in
/// thousandths: 1000 is PyTorch's default of 1.
template <unsigned Thousandths>
struct elu_function {
    static_assert(Thousandths > 0, "elu: alpha must be above 0 thousandths");
    static constexpr const char *name = "elu", *title = "ELU", *type = "tactnet::elu_function",
                                *header = "tactnet/operators/activations/smooth.hpp";
    static constexpr std::array arguments{Thousandths};
    static constexpr bool works_on_vectors = true;

    template <class Number>
    static constexpr Number alpha() {
        constexpr double exact = Thousandths / 1000.0;
        if constexpr (std::same_as<Number, double>)
            return exact;
        else
            return Number(static_cast<float>(exact));
    }
    template <class Number>
    static constexpr Number value(const Number& x) {
        return kernels::choose_lanes(x < Number(0), alpha<Number>() * kernels::exponential_minus_one(x), x);
    }
    /// α · eˣ below 0, which is y + α.
    template <class Number>
    static constexpr Number backward(const Number& y, const Number& gradient) {
        return kernels::choose_lanes(y < Number(0), gradient * (y + alpha<Number>()), gradient);
    }
};

/// log(1 + eˣ), a smooth ReLU (Dugas et al., 2001), within 3 units in the last place; 0 below −87.7.
struct softplus_function {
    static constexpr const char *name = "softplus", *title = "Softplus", *type = "tactnet::softplus_function",
                                *header = "tactnet/operators/activations/smooth.hpp";
    static constexpr bool works_on_vectors = true, moves_zero = true;

    /// max(x, 0) + log(1 + e to the power of −|x|), which does not overflow.
    template <class Number>
    static constexpr Number value(const Number& x) {
        return kernels::at_least(Number(0), x) +
               kernels::log_one_plus(kernels::exponential_of_negative(kernels::negative_magnitude(x)));
    }
    /// 1 − e to the power of −y, as tanh(y ÷ 2) · (1 + that power): the difference would cancel.
    template <class Number>
    static constexpr Number backward(const Number& y, const Number& gradient) {
        const Number half = kernels::hyperbolic_tangent(Number(0.5F) * y);
        return gradient * (half * (Number(1) + kernels::exponential_of_negative(Number(0) - y)));
    }
};

/// x · Φ(x), where Φ is the standard normal distribution (Hendrycks, Gimpel, "Gaussian error linear units",
/// 2016): PyTorch's GELU without approximation. Within 8 units in the last place; 0 below −13.3.
struct gelu_function {
    static constexpr const char *name = "gelu", *title = "GELU", *type = "tactnet::gelu_function",
                                *header = "tactnet/operators/activations/smooth.hpp";
    static constexpr bool works_on_vectors = true;

    /// max(x, 0) − |x| · Φ(−|x|). Φ(−40) is 0 in either precision, and infinity times 0 would be NaN.
    template <class Number>
    static constexpr Number value(const Number& x) {
        return kernels::product_plus(kernels::at_least(Number(-40), kernels::negative_magnitude(x)),
                                     kernels::normal_tail(kernels::magnitude(x)),
                                     kernels::at_least(Number(0), x));
    }
    /// Φ(x) + x · φ(x), where φ is the density.
    template <class Number>
    static constexpr Number backward_from_input(const Number& x, const Number& gradient) {
        const Number tail = kernels::normal_tail(kernels::magnitude(x));
        const Number share = kernels::choose_lanes(x < Number(0), tail, Number(1) - tail);
        return gradient * (share + x * kernels::normal_density(x));
    }
};

/// The layer of sigmoid_function, in place.
using sigmoid = activation<sigmoid_function>;
/// The layer of silu_function.
using silu = activation<silu_function>;
/// The layer of hyperbolic_tangent_function, in place.
using hyperbolic_tangent = activation<hyperbolic_tangent_function>;
/// The layer of elu_function, in place.
template <unsigned Thousandths = 1000>
using elu = activation<elu_function<Thousandths>>;
/// The layer of softplus_function, in place.
using softplus = activation<softplus_function>;
/// The layer of gelu_function.
using gelu = activation<gelu_function>;

}} // namespace tactnet
