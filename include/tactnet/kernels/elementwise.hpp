#pragma once

#include <tactnet/kernels/simd/vector.hpp>

#include <concepts>
#include <cstddef>

// Elementwise operations on `count` values, a multiple of the lanes. Outputs may be the inputs' memory.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// output[i] = operation(input[i]…), vector by vector.
template <class T>
void transform_vectors(auto&& operation, std::size_t count, T* output, const std::same_as<T> auto*... input) {
    for (std::size_t i = 0; i < count; i += lanes<T>)
        store(output + i, operation(load(input + i)...));
}

/// output = max(input, 0); NaN stays NaN.
template <class T>
void relu_forward(const T* input, T* output, std::size_t count) {
    const vector<T> zero(T{});
    transform_vectors([&](const auto& x) { return choose<T>(x < zero, zero, x); }, count, output, input);
}

/// input_gradient = the output gradient where the output is positive, else 0.
template <class T>
void relu_backward(const T* output, const T* output_gradient, T* input_gradient, std::size_t count) {
    const vector<T> zero(T{});
    transform_vectors(
        [&](const auto& y, const auto& gradient) { return choose<T>(y > zero, gradient, zero); }, count,
        input_gradient, output, output_gradient);
}

/// √(x + offset) − √offset, and 0 where x is below 0; NaN stays NaN. Computed as a quotient, since the
/// difference would cancel for small inputs.
template <class T>
[[nodiscard]] auto shifted_root(T offset) {
    const vector<T> shift(offset);
    return [shift, root = square_root<T>(shift)](const vector<T>& x) {
        const vector<T> zero(T{}), y = quotient<vector<T>>(x, square_root<T>(x + shift) + root);
        return choose<T>(x < zero, zero, y);
    };
}

/// input_gradient = the output gradient ÷ (2 √(input + offset)), computed from the output, where that is
/// positive.
template <class T>
void shifted_root_backward(T offset, const T* output, const T* output_gradient, T* input_gradient,
                           std::size_t count) {
    const vector<T> zero(T{}), half(T(0.5)), root = square_root<T>(vector<T>(offset));
    transform_vectors(
        [&](const auto& y, const auto& gradient) {
            return choose<T>(y > zero, quotient<vector<T>>(half * gradient, y + root), zero);
        },
        count, input_gradient, output, output_gradient);
}

/// sum = a + b
template <class T>
void add(const T* a, const T* b, T* sum, std::size_t count) {
    transform_vectors([](const auto& x, const auto& y) { return x + y; }, count, sum, a, b);
}

}}} // namespace tactnet::kernels
