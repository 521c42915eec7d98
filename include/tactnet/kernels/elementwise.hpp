#pragma once

#include <tactnet/kernels/simd/vector.hpp>

#include <cstddef>

// Elementwise operations on `count` values, a multiple of the lanes. Outputs may be the inputs' memory.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// output = max(input, 0); NaN stays NaN.
template <class T>
void relu_forward(const T* input, T* output, std::size_t count) {
    const vector<T> zero(T{});
    for (std::size_t i = 0; i < count; i += lanes<T>) {
        const vector<T> x = load(input + i);
        store(output + i, choose<T>(x < zero, zero, x));
    }
}

/// input_gradient = the output gradient where the output is positive, else 0.
template <class T>
void relu_backward(const T* output, const T* output_gradient, T* input_gradient, std::size_t count) {
    const vector<T> zero(T{});
    for (std::size_t i = 0; i < count; i += lanes<T>)
        store(input_gradient + i, choose<T>(load(output + i) > zero, load(output_gradient + i), zero));
}

/// output = √(input + offset) − √offset, and 0 where the input is below 0; NaN stays NaN. Computed as a
/// quotient, since the difference would cancel for small inputs.
template <class T>
void shifted_root_forward(T offset, const T* input, T* output, std::size_t count) {
    const vector<T> zero(T{}), shift(offset), root = square_root<T>(shift);
    for (std::size_t i = 0; i < count; i += lanes<T>) {
        const vector<T> x = load(input + i), y = x / (square_root<T>(x + shift) + root);
        store(output + i, choose<T>(x < zero, zero, y));
    }
}

/// input_gradient = the output gradient ÷ (2 √(input + offset)), computed from the output, where that is
/// positive.
template <class T>
void shifted_root_backward(T offset, const T* output, const T* output_gradient, T* input_gradient,
                           std::size_t count) {
    const vector<T> zero(T{}), half(T(0.5)), root = square_root<T>(vector<T>(offset));
    for (std::size_t i = 0; i < count; i += lanes<T>) {
        const vector<T> y = load(output + i);
        store(input_gradient + i, choose<T>(y > zero, half * load(output_gradient + i) / (y + root), zero));
    }
}

/// sum = a + b
template <class T>
void add(const T* a, const T* b, T* sum, std::size_t count) {
    for (std::size_t i = 0; i < count; i += lanes<T>)
        store(sum + i, load(a + i) + load(b + i));
}

}}} // namespace tactnet::kernels
