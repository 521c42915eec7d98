#pragma once

#include <tactnet/kernels/simd/special_functions.hpp>
#include <tactnet/operators/activations/function.hpp>

#include <array>
#include <concepts>

// Activations without an exponential, for networks in 8 bits and small processors. In vectors, since
// compilers leave a loop scalar whose branches multiply or divide.

namespace tactnet { inline namespace TACTNET_ARCH {

/// x where x > 0, and a share of x elsewhere, so that no filter stops learning (Maas, Hannun, Ng, "Rectifier
/// nonlinearities improve neural network acoustic models", 2013). The share is in thousandths: 10 is
/// PyTorch's default of 0.01.
template <unsigned Thousandths>
struct leaky_relu_function {
    static_assert(Thousandths > 0 && Thousandths < 1000,
                  "leaky_relu: the slope must be above 0 and below 1000 thousandths");
    static constexpr const char *name = "leaky_relu", *title = "Leaky ReLU",
                                *type = "tactnet::leaky_relu_function",
                                *header = "tactnet/operators/activations/piecewise.hpp";
    static constexpr std::array arguments{Thousandths};
    static constexpr bool works_on_vectors = true, in_registers = true, monotonic = true;

    template <class Number>
    static constexpr Number slope() {
        if constexpr (std::same_as<Number, double>)
            return Thousandths / 1000.0;
        else
            return Number(static_cast<float>(Thousandths) / 1000);
    }
    template <class Number>
    static constexpr Number value(const Number& x) {
        return kernels::choose_lanes(x > Number(0), x, slope<Number>() * x);
    }
    /// The output has the input's sign.
    template <class Number>
    static constexpr Number backward(const Number& y, const Number& gradient) {
        return kernels::choose_lanes(y > Number(0), gradient, slope<Number>() * gradient);
    }
};

/// x clamped to 0 … 6 (Howard et al., "MobileNets", 2017); NaN stays NaN.
struct relu6_function {
    static constexpr const char *name = "relu6", *title = "ReLU6", *type = "tactnet::relu6_function",
                                *header = "tactnet/operators/activations/piecewise.hpp";
    static constexpr bool works_on_vectors = true, in_registers = true, monotonic = true;

    template <class Number>
    static constexpr Number value(const Number& x) {
        return kernels::at_least(Number(0), kernels::at_most(Number(6), x));
    }
    template <class Number>
    static constexpr Number backward(const Number& y, const Number& gradient) {
        return kernels::choose_lanes(y > Number(0), kernels::choose_lanes(y < Number(6), gradient, Number(0)),
                                     Number(0));
    }
};

namespace detail {

/// (x + 3) ÷ 6, at most 1. In single precision by a product, within 2 units in the last place: the sum is
/// exact near −3, and a division would take as long as all the rest.
template <class Number>
[[nodiscard]] constexpr Number hard_share(const Number& x) {
    constexpr auto sixth = [] {
        if constexpr (std::same_as<Number, double>)
            return 1.0 / 6;
        else
            return 1.0F / 6;
    }();
    return kernels::at_most(Number(1), (x + Number(3)) * Number(sixth));
}

} // namespace detail

/// (x + 3) ÷ 6, clamped to 0 … 1 (Howard et al., "Searching for MobileNetV3", 2019); NaN stays NaN.
struct hard_sigmoid_function {
    static constexpr const char *name = "hard_sigmoid", *title = "Hard sigmoid",
                                *type = "tactnet::hard_sigmoid_function",
                                *header = "tactnet/operators/activations/piecewise.hpp";
    static constexpr bool works_on_vectors = true, in_registers = true, moves_zero = true, monotonic = true;
    static constexpr double largest_value = 1;

    template <class Number>
    static constexpr Number value(const Number& x) {
        return kernels::at_least(Number(0), detail::hard_share(x));
    }
    template <class Number>
    static constexpr Number backward(const Number& y, const Number& gradient) {
        return kernels::choose_lanes(
            y > Number(0),
            kernels::choose_lanes(y < Number(1), kernels::quotient(gradient, Number(6)), Number(0)),
            Number(0));
    }
};

/// x · (x + 3) ÷ 6 between −3 and 3, 0 below and x above (same source); NaN stays NaN.
struct hard_swish_function {
    static constexpr const char *name = "hard_swish", *title = "Hard swish",
                                *type = "tactnet::hard_swish_function",
                                *header = "tactnet/operators/activations/piecewise.hpp";
    static constexpr bool works_on_vectors = true, in_registers = true;

    template <class Number>
    static constexpr Number value(const Number& x) {
        const Number from = kernels::at_least(Number(-3), x); // −∞ times 0 would be NaN
        return from * detail::hard_share(from);
    }
    template <class Number>
    static constexpr Number backward_from_input(const Number& x, const Number& gradient) {
        const Number between = gradient * (kernels::quotient<Number>(x + Number(1.5F), Number(3)));
        return kernels::choose_lanes(x > Number(-3), kernels::choose_lanes(x < Number(3), between, gradient),
                                     kernels::choose_lanes(x == x, Number(0), x));
    }
};

/// The layer of leaky_relu_function, in place.
template <unsigned Thousandths = 10>
using leaky_relu = activation<leaky_relu_function<Thousandths>>;
/// The layer of relu6_function, in place.
using relu6 = activation<relu6_function>;
/// The layer of hard_sigmoid_function, in place.
using hard_sigmoid = activation<hard_sigmoid_function>;
/// The layer of hard_swish_function.
using hard_swish = activation<hard_swish_function>;

}} // namespace tactnet
