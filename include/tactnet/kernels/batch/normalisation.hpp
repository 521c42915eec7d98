#pragma once

#include <tactnet/kernels/simd/vector.hpp>

#include <cstddef>

// What batch norms do to the elements of one channel, once the moments are known.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// y = (x − center) × scale + shift
template <class T>
struct normalising {
    T center, scale, shift;

    [[nodiscard]] vector<T> operator()(const vector<T>& x) const {
        return multiply_add<T>(x - vector<T>(center), vector<T>(scale), vector<T>(shift));
    }
};

/// dx = ((x − center) × slope + dy − level) × scale
template <class T>
struct normalising_gradient {
    T center, slope, level, scale;

    [[nodiscard]] vector<T> operator()(const vector<T>& x, const vector<T>& dy) const {
        return multiply_add<T>(x - vector<T>(center), vector<T>(slope), dy - vector<T>(level)) *
               vector<T>(scale);
    }
};

/// Over `count` values, a multiple of the lanes. The output may be the same memory as the input.
template <class T>
void normalise(const normalising<T>& rule, const T* input, T* output, std::size_t count) {
    for (std::size_t i = 0; i < count; i += lanes<T>)
        store(output + i, rule(load(input + i)));
}

/// The way back. Lanes with a zero in `use` get a zero.
template <class T>
void normalise_backward(const normalising_gradient<T>& rule, const vector<T>& use, const T* input,
                        const T* output_gradient, T* input_gradient, std::size_t count) {
    for (std::size_t i = 0; i < count; i += lanes<T>)
        store(input_gradient + i, rule(load(input + i), load(output_gradient + i)) * use);
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
