#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/kernels/fused_activation.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <type_traits>

// An elementwise activation function, in one struct. From it follow the layer activation<Function>
// (operators/activations/layer.hpp), the deployed step in single precision and in 8 bits, its calibration
// and its export as a header. Targets that run an exported network include the file of the function, so that
// file should include no more than this one:
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
// its gradient. Where that does not follow from the output, as for SiLU, write
// `backward_from_input(x, gradient)` instead; the layer then keeps its input. An empty `header` means that
// the deployed network declares the function anyway. In 8 bits a table holds the value of each byte. Optional
// members:
//   arguments           a std::array of the unsigned template arguments of `type`
//   is_relu             true for max(x, 0) alone: in 8 bits a clamp of bytes; the layer before fuses it
//   moves_zero          true unless value(0) is 0
//   largest_value       a bound of |value(x)|, for the limit on inputs of networks that multiply by it
//   works_on_vectors       true if the functions take vectors of floats of any width in place of float
//                       (kernels/simd/float_lanes.hpp, special_functions.hpp): convolutions then fuse it.
//                       If a program links translation units built for different instruction sets, declare
//                       the function in an inline namespace TACTNET_ARCH, as the library does
//   in_registers        true if it takes few operations: convolutions then compute it on sums in registers
//   monotonic           true if, as computed, a larger x never has a smaller value: a max pool after it is
//                       fused too

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <class Function>
concept works_on_vectors = requires { requires Function::works_on_vectors; };
/// What the functions take in single precision.
template <class Function>
using activation_number = std::conditional_t<works_on_vectors<Function>, kernels::vector<float>, float>;
template <class Function>
concept needs_input = requires(activation_number<Function> x) {
    { Function::backward_from_input(x, x) } -> std::same_as<activation_number<Function>>;
};

} // namespace detail

/// A struct that describes an elementwise activation.
template <class Function>
concept activation_function = requires(detail::activation_number<Function> x, double y) {
    { Function::value(x) } -> std::same_as<detail::activation_number<Function>>;
    { Function::value(y) } -> std::same_as<double>;
    requires detail::needs_input<Function> || requires {
        { Function::backward(x, x) } -> std::same_as<detail::activation_number<Function>>;
    };
    { Function::name } -> std::convertible_to<const char*>;
    { Function::title } -> std::convertible_to<const char*>;
    { Function::type } -> std::convertible_to<const char*>;
    { Function::header } -> std::convertible_to<const char*>;
};

/// The elementwise layer of a function, defined in operators/activations/layer.hpp.
template <activation_function Function>
struct activation;

/// max(x, 0); NaN stays NaN.
struct relu_function {
    static constexpr const char *name = "relu", *title = "ReLU", *type = "tactnet::relu_function",
                                *header = "tactnet/operators/activations/function.hpp";
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
concept moves_zero = requires { requires Function::moves_zero; };
template <class Function>
concept in_registers = requires { requires Function::in_registers; };
template <class Function>
concept monotonic = requires { requires Function::monotonic; };
/// A bound of |value(x)|; infinite if there is none.
template <class Function>
[[nodiscard]] constexpr double largest_value() {
    if constexpr (requires { Function::largest_value; })
        return Function::largest_value;
    else
        return std::numeric_limits<double>::infinity();
}
/// The largest magnitude of an output for inputs of at most this magnitude. Functions have no larger value
/// between than at both ends or at the input itself.
template <class Function>
[[nodiscard]] double activation_bound(double input) {
    return std::max({input, std::abs(Function::value(input)), std::abs(Function::value(-input))});
}

/// out[i] = operation(in[i]…) for whole vectors, in vectors if the function takes these.
template <class Function, class T>
void transform(auto&& operation, std::size_t count, T* out, const std::same_as<T> auto*... in) {
    if constexpr (works_on_vectors<Function> && std::same_as<T, float>)
        kernels::transform_vectors(operation, count, out, in...);
    else
        for (std::size_t i = 0; i < count; ++i)
            out[i] = operation(in[i]...);
}

template <class Function>
[[nodiscard]] constexpr kernels::fused_activation describe_fused() {
    kernels::fused_activation fused;
    if constexpr (works_on_vectors<Function>) {
        constexpr bool every_width =
            requires(kernels::sized_vector<float, kernels::min_lanes<float>> x) { Function::value(x); };
        static_assert(
            every_width,
            "activation: a function that says works_on_vectors takes vectors of every width, so that "
            "value is a template");
        if constexpr (every_width) // otherwise more errors follow the assertion
            fused = kernels::fused_activation::with_functions_of<Function>();
    }
    fused.exists = true;
    fused.output_bound = activation_bound<Function>;
    fused.rectifies = is_relu<Function>();
    fused.in_registers = fused.rectifies || in_registers<Function>;
    fused.monotonic = fused.rectifies || monotonic<Function>;
    fused.moves_zero = moves_zero<Function>;
    fused.largest_value = largest_value<Function>();
    fused.title = Function::title, fused.type = Function::type, fused.header = Function::header;
    if constexpr (requires { Function::arguments; })
        fused.arguments = Function::arguments.data(), fused.argument_count = Function::arguments.size();
    return fused;
}
template <class Function>
inline constexpr kernels::fused_activation fused_object = describe_fused<Function>();

} // namespace detail

/// A function whose computation a convolution may do in its epilogue: a ReLU, or one that takes vectors.
template <class Function>
concept fusible_activation = detail::is_relu<Function>() || detail::works_on_vectors<Function>;

/// An activation function as the epilogue of a convolution.
template <class Function>
    requires fusible_activation<Function>
inline constexpr const kernels::fused_activation* fused = &detail::fused_object<Function>;

}} // namespace tactnet
