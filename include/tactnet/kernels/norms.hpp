#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/config.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <ratio>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The groups of elements of a sample [channel][pixel] that a norm brings to mean 0 and variance 1, each
/// group by itself. A group has `channels` × `pixels` elements, and its channels have a weight and a bias
/// each.
struct norm_groups {
    std::size_t count, channels, pixels;
    std::size_t distance;         ///< elements from one group to the next
    std::size_t channel_distance; ///< elements from one channel of a group to the next
    std::size_t weight_distance;  ///< weights from one group to the next; 0 if they share theirs

    /// Groups of as many successive channels, each with all of their pixels.
    [[nodiscard]] static constexpr norm_groups of_channels(std::size_t count, std::size_t channels,
                                                           std::size_t pixels) {
        return {count, channels, pixels, channels * pixels, pixels, channels};
    }
    /// The channels of each pixel.
    [[nodiscard]] static constexpr norm_groups of_pixels(std::size_t channels, std::size_t pixels) {
        return {pixels, channels, 1, 1, pixels, 0};
    }
    [[nodiscard]] constexpr std::size_t size() const { return channels * pixels; }

    /// body(element) for all elements of the first group.
    template <class Body>
    void for_each(const Body& body) const {
        for (std::size_t c = 0; c < channels; ++c)
            for_each_pixel(c, body);
    }
    /// body(element) for the elements of one of its channels.
    template <class Body>
    void for_each_pixel(std::size_t channel, const Body& body) const {
        for (std::size_t e = channel * channel_distance; e < channel * channel_distance + pixels; ++e)
            body(e);
    }
};

// Local response normalisation: y(c) = x(c) · (k + α/n · Σ x²)^−β over n neighbouring channels.

/// Constants of a local response normalisation. The window of channel c begins `before` channels before it.
template <std::size_t Size, class Alpha, class Beta, class K>
struct response_rule {
    static constexpr std::size_t size = Size, before = Size / 2, behind = (Size - 1) / 2;
    static constexpr double beta = static_cast<double>(Beta::num) / static_cast<double>(Beta::den);
    static constexpr double share =
        static_cast<double>(Alpha::num) / static_cast<double>(Alpha::den) / static_cast<double>(Size);
    static constexpr double k = static_cast<double>(K::num) / static_cast<double>(K::den);

    /// x^−β of positive numbers. The usual exponents need square roots only; others are computed lane by
    /// lane, in double.
    template <class T>
    [[nodiscard]] static vector<T> power(const vector<T>& x) {
        const vector<T> one(T{1});
        if constexpr (std::ratio_equal_v<Beta, std::ratio<3, 4>>) {
            const vector<T> root = square_root<T>(x);
            return quotient<vector<T>>(one, root * square_root<T>(root));
        } else if constexpr (std::ratio_equal_v<Beta, std::ratio<1, 2>>) {
            return quotient(one, square_root<T>(x));
        } else if constexpr (std::ratio_equal_v<Beta, std::ratio<1>>) {
            return quotient(one, x);
        } else {
            alignas(vector_alignment) std::array<T, lanes<T>> each;
            store(each.data(), x);
            for (T& value : each)
                value = static_cast<T>(std::pow(static_cast<double>(value), -beta));
            return load(each.data());
        }
    }
    /// k + α/n · Σ x² over the window of channel c; from one channel to the next it is `plane` elements.
    template <class T>
    [[nodiscard]] static vector<T> base(const T* x, std::size_t plane, std::size_t c, std::size_t channels) {
        vector<T> squares(T{});
        const std::size_t end = std::min(c + behind + 1, channels);
        for (std::size_t i = c - std::min(c, before); i < end; ++i) {
            const vector<T> value = load(x + i * plane);
            squares = multiply_add(value, value, squares);
        }
        return multiply_add(squares, vector<T>(static_cast<T>(share)), vector<T>(static_cast<T>(k)));
    }
};

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
                term =
                    quotient<vector<T>>(load(dy + i * plane) * load(x + i * plane) * factors[i % size], base);
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
