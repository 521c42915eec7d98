#pragma once

#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Sums of many terms. Short runs are added in the working precision, lane by lane; the runs are accumulated
// in double. The error stays near that of one rounding, however long the sum is.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

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

}}} // namespace tactnet::kernels
