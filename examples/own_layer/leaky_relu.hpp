#pragma once

// An activation function defined outside the library: leaky ReLU (Maas, Hannun, Ng, 2013), x where x > 0 and
// a small share of x elsewhere, so that no filter stops learning. The library's own tactnet::leaky_relu also
// takes vectors, so that convolutions fuse it; replace this one by a function that the library does not have.
// This file is all that it takes to train the layer, to save it, to deploy it in single precision and in 8
// bits and to export it. A target that runs an exported network needs this file too.

#include <tactnet/operators/activations/function.hpp>

#include <array>

namespace own {

/// max(x, 0) + slope · min(x, 0), with the slope in per cent.
template <unsigned Percent>
struct leaky_relu_function {
    static_assert(Percent > 0 && Percent < 100,
                  "leaky_relu: the slope must be above 0 and below 100 per cent");
    static constexpr const char *name = "leaky_relu", *title = "Leaky ReLU";
    static constexpr const char *type = "own::leaky_relu_function", *header = "leaky_relu.hpp";
    static constexpr std::array arguments{Percent};

    template <class T>
    static constexpr T slope = static_cast<T>(Percent) / 100;
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

/// The layer.
template <unsigned Percent = 1>
using leaky_relu = tactnet::activation<leaky_relu_function<Percent>>;

} // namespace own
