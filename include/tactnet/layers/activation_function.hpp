#pragma once

#include <tactnet/detail/config.hpp>

#include <concepts>

// An elementwise activation function, in one struct. From it follow the layer activation<Function>
// (layers/activation.hpp), the deployed step in single precision and in 8 bits, its calibration and its
// export as a header. Targets that run an exported network include the file of the function, so that file
// should include no more than this one:
//
//     struct hard_tanh_function {
//         static constexpr const char* name = "hard_tanh";  // in weight files
//         static constexpr const char* title = "Hard tanh"; // in comments of exported headers
//         static constexpr const char* type = "own::hard_tanh_function";
//         static constexpr const char* header = "own/hard_tanh.hpp"; // that declares it
//
//         template <class T>
//         static constexpr T value(T x) {
//             return x < -1 ? T(-1) : x > 1 ? T(1) : x;
//         }
//         template <class T>
//         static constexpr T backward(T y, T gradient) {
//             return y > -1 && y < 1 ? gradient : T(0);
//         }
//     };
//     using hard_tanh = tactnet::activation<hard_tanh_function>;
//
// `value` is a function of float and double. `backward` makes the gradient of the input from the output y and
// its gradient. An empty `header` means that the deployed network declares the function anyway. In 8 bits a
// table holds the value of each byte. Optional members:
//   arguments           a std::array of the unsigned template arguments of `type`
//   is_relu             true for max(x, 0) alone: in 8 bits a clamp of bytes; the layer before fuses it
//   moves_zero          true unless value(0) is 0

namespace tactnet { inline namespace TACTNET_ARCH {

/// A struct that describes an elementwise activation.
template <class Function>
concept activation_function = requires(float x, double y) {
    { Function::value(x) } -> std::same_as<float>;
    { Function::value(y) } -> std::same_as<double>;
    { Function::backward(x, x) } -> std::same_as<float>;
    { Function::name } -> std::convertible_to<const char*>;
    { Function::title } -> std::convertible_to<const char*>;
    { Function::type } -> std::convertible_to<const char*>;
    { Function::header } -> std::convertible_to<const char*>;
};

/// The elementwise layer of a function, defined in layers/activation.hpp.
template <activation_function Function>
struct activation;

/// max(x, 0); NaN stays NaN.
struct relu_function {
    static constexpr const char *name = "relu", *title = "ReLU", *type = "tactnet::relu_function",
                                *header = "";
    static constexpr bool is_relu = true;

    template <class T>
    static constexpr T value(T x) {
        return x < 0 ? T(0) : x;
    }
    template <class T>
    static constexpr T backward(T y, T gradient) {
        return y > 0 ? gradient : T(0);
    }
};

namespace detail {

/// Whether a function says that it is max(x, 0).
template <class Function>
[[nodiscard]] constexpr bool is_relu() {
    if constexpr (requires { requires Function::is_relu; }) {
        static_assert(Function::value(-1.0) == 0 && Function::value(1e6) == 1e6,
                      "activation: is_relu is true for a ReLU alone, and this function has other values");
        return true;
    } else {
        return false;
    }
}
template <class Function>
concept moves_zero = requires {
    requires Function::moves_zero;
};

} // namespace detail
}} // namespace tactnet
