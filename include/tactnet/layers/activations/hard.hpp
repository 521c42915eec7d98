#pragma once

#include <tactnet/layers/activation_function.hpp>

// Activations of clamps alone, for networks in 8 bits and processors without an exponential: ReLU6 (Howard et
// al., "MobileNets", 2017), hard sigmoid and hard swish (Howard et al., "Searching for MobileNetV3", 2019).

namespace tactnet { inline namespace TACTNET_ARCH {

/// x clamped to 0 … 6; NaN stays NaN.
struct relu6_function {
    static constexpr const char *name = "relu6", *title = "ReLU6", *type = "tactnet::relu6_function",
                                *header = "tactnet/layers/activations/hard.hpp";

    template <class T>
    static constexpr T value(T x) {
        return x < 0 ? T(0) : x > 6 ? T(6) : x;
    }
    template <class T>
    static constexpr T backward(T y, T gradient) {
        return y > 0 && y < 6 ? gradient : T(0);
    }
};

/// (x + 3) ÷ 6, clamped to 0 … 1; NaN stays NaN.
struct hard_sigmoid_function {
    static constexpr const char *name = "hard_sigmoid", *title = "Hard sigmoid",
                                *type = "tactnet::hard_sigmoid_function",
                                *header = "tactnet/layers/activations/hard.hpp";
    static constexpr bool moves_zero = true;

    template <class T>
    static constexpr T value(T x) {
        return x <= -3 ? T(0) : x >= 3 ? T(1) : (x + 3) / 6;
    }
    template <class T>
    static constexpr T backward(T y, T gradient) {
        return y > 0 && y < 1 ? gradient / 6 : T(0);
    }
};

/// x · (x + 3) ÷ 6 between −3 and 3, 0 below and x above; NaN stays NaN.
struct hard_swish_function {
    static constexpr const char *name = "hard_swish", *title = "Hard swish",
                                *type = "tactnet::hard_swish_function",
                                *header = "tactnet/layers/activations/hard.hpp";

    template <class T>
    static constexpr T value(T x) {
        return x <= -3 ? T(0) : x >= 3 ? x : x * ((x + 3) / 6);
    }
    template <class T>
    static constexpr T backward_from_input(T x, T gradient) {
        return x <= -3 ? T(0) : x >= 3 ? gradient : gradient * ((x + T(1.5)) / 3);
    }
};

using relu6 = activation<relu6_function>;
using hard_sigmoid = activation<hard_sigmoid_function>;
using hard_swish = activation<hard_swish_function>;

}} // namespace tactnet
