#pragma once

#include <tactnet/kernels/simd/sized_vector.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

// Operations on one or two rows: dot products, distances, weighted sums, softmax. Unless a comment says
// otherwise, rows are aligned and hold whole vectors.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// a · b over `count` floats, a multiple of a cache line. Accumulates short runs in single precision and adds
/// these in double.
[[nodiscard]] inline double dot(const float* a, const float* b, std::size_t count) {
    // One line at a time, by as many chains as hide the latency.
    constexpr std::size_t width = lanes<float>, chains = 4, run = 64 * chains * width;
    double total = 0;
    for (std::size_t first = 0; first < count; first += run) {
        const std::size_t end = std::min(first + run, count);
        std::array<vector<float>, chains> sums;
        sums.fill(vector<float>(0.0F));
        std::size_t i = first;
        for (; i + chains * width <= end; i += chains * width)
            for (std::size_t c = 0; c < chains; ++c)
                sums[c] = multiply_add(load(a + i + c * width), load(b + i + c * width), sums[c]);
        for (; i < end; i += width)
            sums[0] = multiply_add(load(a + i), load(b + i), sums[0]);
        total = add_lanes<float, width>((sums[0] + sums[1]) + (sums[2] + sums[3]), total);
    }
    return total;
}

/// to += factor · from, over `count` floats.
inline void add_multiple(float* to, float factor, const float* from, std::size_t count) {
    const vector<float> f(factor);
    for (std::size_t i = 0; i < count; i += lanes<float>)
        store(to + i, multiply_add(f, load(from + i), load(to + i)));
}

/// Σ (a[i] − b[i])² over Length values. All terms have one sign, so nothing cancels.
template <std::size_t Length>
[[nodiscard]] inline float squared_distance(const float* a, const float* b) {
    static_assert(Length % lanes<float> == 0);
    vector<float> squares(0.0f);
    for (std::size_t i = 0; i < Length; i += lanes<float>) {
        const vector<float> difference = load(a + i) - load(b + i);
        squares = multiply_add(difference, difference, squares);
    }
    return add_lanes<float, lanes<float>>(squares);
}

/// sums[c] = Σ weights[r] · rows[r][c] in double, in the order of the rows. `width`, the length of a row, is
/// a multiple of the lanes.
inline void weighted_row_sums(const float* weights, const double* rows, std::size_t count, std::size_t width,
                              double* sums) {
    using v = vector<double>;
    std::fill_n(sums, width, 0.0);
    for (std::size_t r = 0; r < count; ++r) {
        const v weight(static_cast<double>(weights[r]));
        for (std::size_t c = 0; c < width; c += lanes<double>)
            store(sums + c, multiply_add(weight, load(rows + r * width + c), load(sums + c)));
    }
}

/// to[0 … Length − 1] = Σ weights[i] · from[i · stride + 0 … Length − 1], over `count` rows. Rows are aligned
/// to vectors of lanes_for<float>(Length), whose width divides Length.
template <std::size_t Length>
inline void weighted_sum(const float* from, std::size_t stride, const float* weights, std::size_t count,
                         float* to) {
    constexpr std::size_t width = lanes_for<float>(Length);
    using wide = sized_vector<float, width>;
    static_assert(Length % width == 0);
    for (std::size_t first = 0; first < Length; first += width) {
        wide sum(0.0f);
        for (std::size_t i = 0; i < count; ++i)
            sum = fused_multiply_add(load_as<wide>(from + i * stride + first), wide(weights[i]), sum);
        store_as(to + first, sum);
    }
}

/// The Euclidean norm of Length values, in vectors of lanes_for<float>(Length).
template <std::size_t Length>
[[nodiscard]] inline float euclidean_norm(const float* values) {
    constexpr std::size_t width = lanes_for<float>(Length);
    using wide = sized_vector<float, width>;
    static_assert(Length % width == 0);
    wide squares(0.0f);
    for (std::size_t i = 0; i < Length; i += width) {
        const wide v = load_as<wide>(values + i);
        squares = fused_multiply_add(v, v, squares);
    }
    return std::sqrt(add_lanes<float, width>(squares));
}

/// values[i] *= factor, in vectors of lanes_for<float>(Length).
template <std::size_t Length>
inline void scale_row(float* values, float factor) {
    constexpr std::size_t width = lanes_for<float>(Length);
    using wide = sized_vector<float, width>;
    static_assert(Length % width == 0);
    for (std::size_t i = 0; i < Length; i += width)
        store_as(values + i, load_as<wide>(values + i) * wide(factor));
}

/// exp(x) / Σ exp(x), with the largest logit subtracted so that nothing overflows. Accumulates in double, may
/// work in place, and needs no alignment.
template <class T>
void softmax_of(std::span<const T> logits, std::span<T> probabilities) noexcept {
    const double largest = static_cast<double>(*std::max_element(logits.begin(), logits.end()));
    double sum = 0;
    for (const T logit : logits)
        sum += std::exp(static_cast<double>(logit) - largest);
    for (std::size_t i = 0; i < logits.size(); ++i)
        probabilities[i] = static_cast<T>(std::exp(static_cast<double>(logits[i]) - largest) / sum);
}

}}} // namespace tactnet::kernels
