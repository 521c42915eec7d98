#pragma once

#include <tactnet/layers/activation_function.hpp>

#include <array>

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
                                *header = "tactnet/layers/activations/leaky_relu.hpp";
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

template <unsigned Thousandths = 10>
using leaky_relu = activation<leaky_relu_function<Thousandths>>;

}} // namespace tactnet
