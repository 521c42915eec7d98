#pragma once

#include <tactnet/layers/activations/activation_function.hpp>

#include <array>

// Activations without an exponential, for networks in 8 bits and small processors.

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
                                *header = "tactnet/layers/activations/piecewise.hpp";
    static constexpr std::array arguments{Thousandths};

    template <class T>
    static constexpr T slope = static_cast<T>(Thousandths) / 1000;
    template <class T>
    static constexpr T value(T x) {
        return x > 0 ? x : slope<T> * x;
    }
    /// The output has the input's sign.
    template <class T>
    static constexpr T backward(T y, T gradient) {
        return y > 0 ? gradient : slope<T> * gradient;
    }
};

/// x clamped to 0 … 6 (Howard et al., "MobileNets", 2017); NaN stays NaN.
struct relu6_function {
    static constexpr const char *name = "relu6", *title = "ReLU6", *type = "tactnet::relu6_function",
                                *header = "tactnet/layers/activations/piecewise.hpp";

    template <class T>
    static constexpr T value(T x) {
        return x < 0 ? T(0) : x > 6 ? T(6) : x;
    }
    template <class T>
    static constexpr T backward(T y, T gradient) {
        return y > 0 && y < 6 ? gradient : T(0);
    }
};

/// (x + 3) ÷ 6, clamped to 0 … 1 (Howard et al., "Searching for MobileNetV3", 2019); NaN stays NaN.
struct hard_sigmoid_function {
    static constexpr const char *name = "hard_sigmoid", *title = "Hard sigmoid",
                                *type = "tactnet::hard_sigmoid_function",
                                *header = "tactnet/layers/activations/piecewise.hpp";
    static constexpr bool moves_zero = true;
    static constexpr double largest_value = 1;

    template <class T>
    static constexpr T value(T x) {
        return x <= -3 ? T(0) : x >= 3 ? T(1) : (x + 3) / 6;
    }
    template <class T>
    static constexpr T backward(T y, T gradient) {
        return y > 0 && y < 1 ? gradient / 6 : T(0);
    }
};

/// x · (x + 3) ÷ 6 between −3 and 3, 0 below and x above (same source); NaN stays NaN.
struct hard_swish_function {
    static constexpr const char *name = "hard_swish", *title = "Hard swish",
                                *type = "tactnet::hard_swish_function",
                                *header = "tactnet/layers/activations/piecewise.hpp";

    template <class T>
    static constexpr T value(T x) {
        return x <= -3 ? T(0) : x >= 3 ? x : x * ((x + 3) / 6);
    }
    template <class T>
    static constexpr T backward_from_input(T x, T gradient) {
        return x <= -3 ? T(0) : x >= 3 ? gradient : gradient * ((x + T(1.5)) / 3);
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
