#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

// From the response of an elastic layer to waves to the influence between square cells: the Hankel transform
// gives the response at a distance, quadrature the mean over a cell.

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// The Bessel function J₀ for z ≥ 0, within 1e-11: the power series below 13, and Hankel's asymptotic series
/// beyond (Abramowitz and Stegun, 9.1.10 and 9.2.5).
[[nodiscard]] inline double bessel_zero(double z) {
    if (z < 13) {
        const double quarter = -z * z / 4;
        double term = 1, sum = 1;
        for (int n = 1; std::abs(term) > 1e-17; ++n)
            sum += term *= quarter / (n * n);
        return sum;
    }
    double even = 0, odd = 0, term = 1;
    for (int n = 0; n < 14; n += 2) {
        even += term;
        term *= (2 * n + 1) * (2 * n + 1) / (8 * z * (n + 1));
        odd -= term;
        term *= -(2 * n + 3) * (2 * n + 3) / (8 * z * (n + 2));
    }
    const double phase = z - std::numbers::pi / 4;
    return std::sqrt(2 / (std::numbers::pi * z)) * (even * std::cos(phase) - odd * std::sin(phase));
}

/// A node and its weight of Gauss-Legendre quadrature on [−1, 1].
struct gauss_point {
    double place, weight;
};
/// The four points of a Gauss-Legendre rule.
inline constexpr std::array<gauss_point, 4> four_points{{{-0.861136311594052575, 0.347854845137453857},
                                                         {-0.339981043584856265, 0.652145154862546143},
                                                         {0.339981043584856265, 0.652145154862546143},
                                                         {0.861136311594052575, 0.347854845137453857}}};

/// A rectangle to integrate over.
struct rectangle {
    double left, right, bottom, top;
};

/// ∬ f(x, y) over a rectangle, where f is smooth on the scale of `smooth` or of the distance from the origin,
/// whichever is larger. Rectangles large compared with that are quartered.
template <class Function>
[[nodiscard]] double integrate(const rectangle& over, double smooth, const Function& f) {
    const double width = over.right - over.left, height = over.top - over.bottom;
    const double x = std::max({over.left, -over.right, 0.0}), y = std::max({over.bottom, -over.top, 0.0});
    const double middle = (over.left + over.right) / 2, centre = (over.bottom + over.top) / 2;
    if (2 * std::max(width, height) > std::hypot(x, y, smooth))
        return integrate({over.left, middle, over.bottom, centre}, smooth, f) +
               integrate({middle, over.right, over.bottom, centre}, smooth, f) +
               integrate({over.left, middle, centre, over.top}, smooth, f) +
               integrate({middle, over.right, centre, over.top}, smooth, f);
    double sum = 0;
    for (const gauss_point& row : four_points)
        for (const gauss_point& column : four_points)
            sum += row.weight * column.weight *
                   f(middle + width / 2 * column.place, centre + height / 2 * row.place);
    return sum * width * height / 4;
}

/// f(s) = ∫₀^∞ g(x) J₀(xs) dx as a table, for a g that is smooth on the scale of one and vanishes at `end`.
/// Beyond the table f is g(0) / s: the rest decays like e⁻ᵃˢ, where a, the distance of the nearest pole of g
/// from the real axis, is at least 0.739 for the layers of layer_compliance.hpp.
class radial_kernel {
public:
    template <class Function>
    radial_kernel(const Function& g, double end) : tail_(g(0.0)), values_(points) {
        for (std::size_t i = 0; i < points; ++i) {
            const double s = std::sinh((static_cast<double>(i) - 1) * step);
            // Half a period of the Bessel function per four points.
            const auto pieces = static_cast<std::size_t>(end * std::max(std::abs(s), 10.0) / 2) + 1;
            const double half = end / static_cast<double>(2 * pieces);
            double sum = 0;
            for (std::size_t piece = 0; piece < pieces; ++piece)
                for (const gauss_point& point : four_points) {
                    const double x = half * (static_cast<double>(2 * piece + 1) + point.place);
                    sum += point.weight * g(x) * bessel_zero(x * std::abs(s));
                }
            values_[i] = sum * half;
        }
    }

    [[nodiscard]] double operator()(double s) const {
        const double place = std::asinh(s) / step;
        if (!(place < static_cast<double>(points - 3)))
            return tail_ / s;
        const auto first = static_cast<std::size_t>(place);
        const double t = place - static_cast<double>(first);
        const double* const v = values_.data() + first; // at −1, 0, 1 and 2
        // Lagrange's cubic.
        return v[0] * t * (t - 1) * (2 - t) / 6 + v[1] * (t + 1) * (t - 1) * (t - 2) / 2 +
               v[2] * (t + 1) * t * (2 - t) / 2 + v[3] * (t + 1) * t * (t - 1) / 6;
    }
    /// Beyond this s, only the tail remains.
    static constexpr double support = 34;

private:
    // Uniform steps in asinh s: dense near zero, wide in the tail.
    static constexpr double step = 0.02;
    static constexpr std::size_t points = 216; // to s = sinh 4.24 = 34.7

    double tail_;
    std::vector<double> values_;
};

}}} // namespace tactnet::simulation
