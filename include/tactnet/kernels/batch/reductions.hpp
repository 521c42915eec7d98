#pragma once

#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Numbers of either precision, computed in double and rounded once.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Loads floats or doubles as doubles.
[[nodiscard]] inline vector<double> load_double(const float* from) {
    return widen(from);
}
[[nodiscard]] inline vector<double> load_double(const double* from) {
    return load(from);
}
/// Rounds doubles to floats, or keeps them, and stores them.
inline void store_double(float* to, const vector<double>& values) {
    narrow(to, values);
}
inline void store_double(double* to, const vector<double>& values) {
    store(to, values);
}

// Sums of many terms. Short runs are added in the working precision, lane by lane; the runs are accumulated
// in double. The error stays near that of one rounding, however long the sum is.

/// Terms that are added in the working precision.
inline constexpr std::size_t run_length = 16;

/// Computes `Sums` sums over the vectors 0 … count − 1 and all lanes; term(i) returns one vector per sum.
template <std::size_t Sums, class T, class Term>
[[nodiscard]] std::array<double, Sums> sum_terms(std::size_t count, Term&& term) {
    std::array<std::array<double, lanes<T>>, Sums> totals{};
    for (std::size_t first = 0; first < count; first += run_length) {
        std::array<vector<T>, Sums> run = term(first);
        const std::size_t end = std::min(first + run_length, count);
        for (std::size_t i = first + 1; i < end; ++i) {
            const std::array<vector<T>, Sums> next = term(i);
            for (std::size_t s = 0; s < Sums; ++s)
                run[s] += next[s];
        }
        for (std::size_t s = 0; s < Sums; ++s)
            add_each_lane<T>(totals[s].data(), run[s]);
    }
    std::array<double, Sums> result{};
    for (std::size_t s = 0; s < Sums; ++s)
        for (const double lane : totals[s])
            result[s] += lane;
    return result;
}

/// Ones in the first `used` lanes, zeros in the others.
template <class T>
[[nodiscard]] vector<T> lanes_in_use(std::size_t used) {
    alignas(vector_alignment) std::array<T, lanes<T>> flat{};
    std::fill_n(flat.begin(), used, T{1});
    return load(flat.data());
}

/// Count, mean and sum of squared deviations. Parts are merged by the update of Chan, Golub and LeVeque,
/// which does not cancel if the mean is large compared with the deviation.
struct moments {
    double count = 0;
    double mean = 0;
    double squares = 0;

    void add(const moments& other) {
        if (other.count == 0)
            return;
        const double total = count + other.count, distance = other.mean - mean;
        mean += distance * other.count / total;
        squares += other.squares + distance * distance * count * other.count / total;
        count = total;
    }
    /// The population variance (divided by the count).
    [[nodiscard]] double variance() const { return count > 0 ? squares / count : 0; }
};

/// The moments of the first `used` lanes of `count` vectors, accumulated relative to the first value.
template <class T>
[[nodiscard]] moments moments_of(const T* values, std::size_t count, std::size_t used) {
    const vector<T> origin(values[0]), use = lanes_in_use<T>(used);
    const auto [sum, squares] = sum_terms<2, T>(count, [&](std::size_t i) {
        const vector<T> d = (load(values + i * lanes<T>) - origin) * use;
        return std::array<vector<T>, 2>{d, d * d};
    });
    const double n = static_cast<double>(count * used), mean = sum / n;
    return {n, static_cast<double>(values[0]) + mean, std::max(squares - sum * mean, 0.0)};
}

// A lane block [channel][pixel][lane] times a factor for each channel of each sample, [channel][lane].

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
