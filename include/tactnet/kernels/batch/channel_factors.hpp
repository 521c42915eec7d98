#pragma once

#include <tactnet/kernels/simd/in_double.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <cstddef>

// A lane block [channel][pixel][lane] times a factor for each channel of each sample, [channel][lane].

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// output = input × the factor of its channel.
template <class T>
void multiply_channels(std::size_t channels, std::size_t pixels, const T* input, const T* factors,
                       T* output) {
    for (std::size_t c = 0; c < channels; ++c) {
        const vector<T> factor = load(factors + c * lanes<T>);
        for (std::size_t e = c * pixels; e < (c + 1) * pixels; ++e)
            store(output + e * lanes<T>, load(input + e * lanes<T>) * factor);
    }
}

/// factor_gradients = the sum over the pixels of each channel of input × output gradient, in double.
template <class T>
void multiply_channels_backward(std::size_t channels, std::size_t pixels, const T* input,
                                const T* output_gradient, T* factor_gradients) {
    for (std::size_t c = 0; c < channels; ++c)
        for (std::size_t half = 0; half < lanes<T>; half += lanes<double>) {
            vector<double> sum(0.0);
            for (std::size_t e = c * pixels; e < (c + 1) * pixels; ++e)
                sum = multiply_add<double>(load_double(input + e * lanes<T> + half),
                                           load_double(output_gradient + e * lanes<T> + half), sum);
            store_double(factor_gradients + c * lanes<T> + half, sum);
        }
}

/// input_gradient += output gradient × the factor of its channel.
template <class T>
void add_multiplied_channels(std::size_t channels, std::size_t pixels, const T* output_gradient,
                             const T* factors, T* input_gradient) {
    for (std::size_t c = 0; c < channels; ++c) {
        const vector<T> factor = load(factors + c * lanes<T>);
        for (std::size_t e = c * pixels; e < (c + 1) * pixels; ++e) {
            T* const to = input_gradient + e * lanes<T>;
            store(to, multiply_add<T>(load(output_gradient + e * lanes<T>), factor, load<T>(to)));
        }
    }
}

}}} // namespace tactnet::kernels
