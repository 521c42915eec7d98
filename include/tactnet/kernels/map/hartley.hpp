#pragma once

#include <tactnet/kernels/simd/vector.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

// The discrete Hartley transform H[k] = Σ x[n] (cos 2πnk/N + sin 2πnk/N) of as many signals side by side as a
// vector has lanes. It is real and, apart from a factor N, its own inverse. Like Fourier's, it turns a
// circular convolution with an even kernel into a product, with half the work (Bracewell, The Hartley
// Transform, 1986).
//
// One step combines the transforms E and O of the even and the odd samples, M = N/2 each:
//
//     H[k]     = E[k] + a[k],     a[k]   = cos(2πk/N) O[k] + sin(2πk/N) O[M−k]
//     H[k + M] = E[k] − a[k],     a[M−k] = sin(2πk/N) O[k] − cos(2πk/N) O[M−k].
//
// These steps, from N = 2 up, turn samples in bit-reversed order into a transform in natural order. The
// transform is symmetric, so the transposed steps, from N down, turn samples in natural order into a
// transform in bit-reversed order: convolutions need no reordering.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Transforms of `Size` samples, a power of two. Sample n of the signals is the vector at data + n ·
/// lanes<double>.
template <std::size_t Size>
class hartley {
    static_assert(Size >= 4 && (Size & (Size - 1)) == 0,
                  "hartley: the size must be a power of two from 4 on");
    using v = vector<double>;
    static constexpr std::size_t quarter = Size / 4;

public:
    hartley() {
        for (std::size_t k = 0; k < quarter; ++k) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(Size);
            cosines_[k] = std::cos(angle), sines_[k] = std::sin(angle);
        }
    }

    /// Transforms samples in natural order; the result is in bit-reversed order.
    void to_reversed(double* data) const { split<Size>(data); }
    /// Transforms samples in bit-reversed order; the result is in natural order.
    void from_reversed(double* data) const { join<Size>(data); }

private:
    /// Stores a and b at places `first` and `second`.
    static void put(double* data, std::size_t first, const v& a, std::size_t second, const v& b) {
        store(data + first * lanes<double>, a);
        store(data + second * lanes<double>, b);
    }
    static v at(const double* data, std::size_t place) { return load(data + place * lanes<double>); }

    /// Replaces x and y by x + y and x − y.
    static void sum_and_difference(double* data, std::size_t x, std::size_t y) {
        const v first = at(data, x), second = at(data, y);
        put(data, x, first + second, y, first - second);
    }
    static void split_four(double* data) {
        const v a = at(data, 0) + at(data, 2), b = at(data, 1) + at(data, 3), c = at(data, 0) - at(data, 2),
                d = at(data, 1) - at(data, 3);
        put(data, 0, a + b, 1, a - b);
        put(data, 2, c + d, 3, c - d);
    }
    static void join_four(double* data) {
        const v a = at(data, 0) + at(data, 1), b = at(data, 0) - at(data, 1), c = at(data, 2) + at(data, 3),
                d = at(data, 2) - at(data, 3);
        put(data, 0, a + c, 2, a - c);
        put(data, 1, b + d, 3, b - d);
    }

    template <std::size_t N>
    void split(double* data) const {
        if constexpr (N == 4) {
            split_four(data);
        } else {
            constexpr std::size_t half = N / 2, step = Size / N;
            sum_and_difference(data, 0, half);
            sum_and_difference(data, half / 2, half + half / 2);
            for (std::size_t k = 1; k < half / 2; ++k) {
                const v cosine(cosines_[k * step]), sine(sines_[k * step]);
                const v a = at(data, k), b = at(data, half + k), c = at(data, half - k), d = at(data, N - k);
                const v low = a - b, high = c - d;
                put(data, k, a + b, half - k, c + d);
                put(data, half + k, multiply_add<double>(cosine, low, sine * high), N - k,
                    sine * low - cosine * high);
            }
            split<half>(data);
            split<half>(data + half * lanes<double>);
        }
    }
    template <std::size_t N>
    void join(double* data) const {
        if constexpr (N == 4) {
            join_four(data);
        } else {
            constexpr std::size_t half = N / 2, step = Size / N;
            join<half>(data);
            join<half>(data + half * lanes<double>);
            sum_and_difference(data, 0, half);
            sum_and_difference(data, half / 2, half + half / 2);
            for (std::size_t k = 1; k < half / 2; ++k) {
                const v cosine(cosines_[k * step]), sine(sines_[k * step]);
                const v a = at(data, k), b = at(data, half + k), c = at(data, half - k), d = at(data, N - k);
                const v low = multiply_add<double>(cosine, b, sine * d), high = sine * b - cosine * d;
                put(data, k, a + low, half + k, a - low);
                put(data, half - k, c + high, N - k, c - high);
            }
        }
    }

    std::array<double, quarter> cosines_, sines_;
};

}}} // namespace tactnet::kernels
