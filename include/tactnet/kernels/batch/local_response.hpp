#pragma once

#include <tactnet/kernels/response_rule.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <array>
#include <cstddef>

// Local response normalisation: y(c) = x(c) · (k + α/n · Σ x²)^−β over n neighbouring channels.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Normalises one lane block, [channel][pixel][lane].
template <class Rule, class T>
void normalise_responses(std::size_t channels, std::size_t pixels, const T* input, T* output) {
    const std::size_t plane = pixels * lanes<T>;
    for (std::size_t c = 0; c < channels; ++c)
        for (std::size_t at = 0; at < plane; at += lanes<T>) {
            const vector<T> factor = Rule::template power<T>(Rule::base(input + at, plane, c, channels));
            store(output + c * plane + at, load(input + c * plane + at) * factor);
        }
}

/// dx(c) = dy(c) b(c)^−β − 2 α/n β x(c) Σ dy(i) x(i) b(i)^(−β−1) over all i whose window holds c.
template <class Rule, class T>
void normalise_responses_backward(std::size_t channels, std::size_t pixels, const T* input,
                                  const T* output_gradient, T* input_gradient) {
    const std::size_t plane = pixels * lanes<T>;
    const vector<T> scale(static_cast<T>(-2 * Rule::share * Rule::beta));
    constexpr std::size_t size = Rule::size, ahead = Rule::before;
    for (std::size_t at = 0; at < plane; at += lanes<T>) {
        // Terms of the sum and factors of the last `size` channels, in a ring.
        std::array<vector<T>, size> terms, factors;
        terms.fill(vector<T>(T{}));
        factors.fill(vector<T>(T{}));
        for (std::size_t i = 0; i < channels + ahead; ++i) {
            const T *const x = input + at, *const dy = output_gradient + at;
            vector<T> term(T{});
            if (i < channels) {
                const vector<T> base = Rule::base(x, plane, i, channels);
                factors[i % size] = Rule::template power<T>(base);
                term = load(dy + i * plane) * load(x + i * plane) * factors[i % size] / base;
            }
            terms[i % size] = term;
            if (i < ahead)
                continue;
            const std::size_t c = i - ahead;
            vector<T> sum = terms[0];
            for (std::size_t t = 1; t < size; ++t)
                sum = sum + terms[t];
            store(input_gradient + at + c * plane,
                  multiply_add(scale * load(x + c * plane), sum, load(dy + c * plane) * factors[c % size]));
        }
    }
}

}}} // namespace tactnet::kernels
