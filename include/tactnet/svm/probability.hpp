#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

// Probabilities from decision values.

namespace tactnet { inline namespace TACTNET_ARCH {

/// P(first class | value) = 1 / (1 + exp(slope · value + offset))
struct platt_sigmoid {
    double slope = 0;
    double offset = 0;

    [[nodiscard]] double probability(double value) const {
        const double z = slope * value + offset;
        // The equivalent expression whose exponential cannot overflow.
        return z >= 0 ? std::exp(-z) / (1 + std::exp(-z)) : 1 / (1 + std::exp(z));
    }
};

/// Maximum likelihood with Platt's targets, by Newton's method with backtracking (Lin, Lin and Weng, "A note
/// on Platt's probabilistic outputs for support vector machines", Machine Learning 68, 2007). `sides` above
/// zero are the first class. The values should come from machines that have not seen the samples.
[[nodiscard]] inline platt_sigmoid fit_platt_sigmoid(std::span<const double> values,
                                                     std::span<const double> sides) {
    constexpr std::size_t max_iterations = 100;
    constexpr double least_step = 1e-10, ridge = 1e-12, enough = 1e-5;
    double first = 0, second = 0;
    for (const double side : sides)
        (side > 0 ? first : second) += 1;
    const double high = (first + 1) / (first + 2), low = 1 / (second + 2);
    const auto target = [&](std::size_t i) { return sides[i] > 0 ? high : low; };
    const auto loss = [&](const platt_sigmoid& s) {
        double sum = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double z = values[i] * s.slope + s.offset;
            sum += z >= 0 ? target(i) * z + std::log1p(std::exp(-z))
                          : (target(i) - 1) * z + std::log1p(std::exp(z));
        }
        return sum;
    };

    platt_sigmoid s{0, std::log((second + 1) / (first + 1))};
    double now = loss(s);
    for (std::size_t iteration = 0; iteration < max_iterations; ++iteration) {
        double h11 = ridge, h22 = ridge, h21 = 0, g1 = 0, g2 = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double p = s.probability(values[i]), d2 = p * (1 - p), d1 = target(i) - p;
            h11 += values[i] * values[i] * d2;
            h22 += d2;
            h21 += values[i] * d2;
            g1 += values[i] * d1;
            g2 += d1;
        }
        if (std::abs(g1) < enough && std::abs(g2) < enough)
            break;
        const double determinant = h11 * h22 - h21 * h21;
        const double d_slope = -(h22 * g1 - h21 * g2) / determinant,
                     d_offset = -(-h21 * g1 + h11 * g2) / determinant;
        const double descent = g1 * d_slope + g2 * d_offset;
        double step = 1;
        for (; step >= least_step; step /= 2) {
            const platt_sigmoid next{s.slope + step * d_slope, s.offset + step * d_offset};
            const double reached = loss(next);
            if (reached < now + 1e-4 * step * descent) {
                s = next;
                now = reached;
                break;
            }
        }
        if (step < least_step)
            break;
    }
    return s;
}

/// Probabilities of all classes from those of each pair, `pairwise[i][j]` = P(i | i or j), row by row (Wu,
/// Lin and Weng, "Probability estimates for multi-class classification by pairwise coupling", JMLR 5, 2004,
/// second method). They are clamped to 1e-7 … 1 − 1e-7: a class that is certain against all others would
/// lead to a division by zero.
[[nodiscard]] inline std::vector<double> couple_pairwise(std::span<const double> pairwise,
                                                         std::size_t classes) {
    const std::size_t k = classes;
    constexpr double least = 1e-7;
    const auto r = [&](std::size_t i, std::size_t j) {
        return std::clamp(pairwise[i * k + j], least, 1 - least);
    };
    std::vector<double> q(k * k), p(k, 1 / static_cast<double>(k)), qp(k);
    for (std::size_t t = 0; t < k; ++t)
        for (std::size_t j = 0; j < k; ++j)
            if (j != t) {
                q[t * k + t] += r(j, t) * r(j, t);
                q[t * k + j] = -r(j, t) * r(t, j);
            }
    const double enough = 0.005 / static_cast<double>(k);
    const std::size_t max_iterations = std::max<std::size_t>(100, k);
    for (std::size_t iteration = 0; iteration < max_iterations; ++iteration) {
        double whole = 0, error = 0;
        for (std::size_t t = 0; t < k; ++t) {
            qp[t] = 0;
            for (std::size_t j = 0; j < k; ++j)
                qp[t] += q[t * k + j] * p[j];
            whole += p[t] * qp[t];
        }
        for (std::size_t t = 0; t < k; ++t)
            error = std::max(error, std::abs(qp[t] - whole));
        if (error < enough)
            break;
        for (std::size_t t = 0; t < k; ++t) {
            const double change = (whole - qp[t]) / q[t * k + t], norm = 1 + change;
            p[t] += change;
            whole = (whole + change * (change * q[t * k + t] + 2 * qp[t])) / norm / norm;
            for (std::size_t j = 0; j < k; ++j) {
                qp[j] = (qp[j] + change * q[t * k + j]) / norm;
                p[j] /= norm;
            }
        }
    }
    return p;
}

}} // namespace tactnet
