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

// An elastic layer of thickness h, bonded to a rigid base, under a frictionless pressure p cos kx on its
// surface. Each Fourier component of a map is such a state of plane strain, where k is the length of the wave
// vector.
//
// Derived from Airy's stress function f(z) cos kx, with z upwards from the base,
//
//     f = (A + B kz) cosh kz + (C + D kz) sinh kz,    σzz = −k² f cos kx,    σxz = k f' sin kx.
//
// The base neither stretches, f'' + ν / (1 − ν) k² f = 0, nor tilts, (1 − ν) f''' = (2 − ν) k² f', so that
// A = −m D and C = n B with m = 2 (1 − ν), n = 1 − 2ν. No shear and the pressure p on the surface, f'(h) = 0
// and k² f(h) = p, give with x = kh
//
//     D = −q (m cosh x + x sinh x),    B = q (x cosh x − n sinh x),    q = p / k² / (x² + m² + κ sinh² x)
//
// where κ = m² − n² = m + n = 3 − 4ν. The pressure on the base is k² A, and the surface sinks by
// −f'''(h) / (E* k²), E* = E / (1 − ν²): with 2m² − κ = (κ² + 1) / 2 the two formulas below. See Johnson,
// Contact Mechanics, 1985, section 5.8, on layered solids.
//
// For −1 < ν ≤ ½ both are finite for all x from 0 to infinity, since numerator and denominator are divided by
// their growing factors.

namespace detail {
inline constexpr double endless_wave = 300; ///< beyond this x, e⁻²ˣ is negligible

/// sinh y − y for y ≥ 0, also accurate for small y.
[[nodiscard]] inline double sinh_beyond_linear(double y) {
    if (y > 1)
        return std::sinh(y) - y;
    const double s = y * y;
    double sum = 1;
    for (int n = 8; n > 1; --n)
        sum = 1 + sum * s / (2 * n * (2 * n + 1));
    return y * s / 6 * sum;
}
} // namespace detail

/// The compliance of the layer relative to a half space of the same material: the deflection is
/// û = 2 / (E* k) · M(kh) · p̂,
///
///     M(x) = (κ sinh 2x − 2x) / (κ cosh 2x + 2x² + (κ² + 1) / 2).
///
/// A thick layer is a half space, M → 1. A thin one is a bed of springs, M → x (1 − 2ν) / (2 (1 − ν)²), that
/// is û = h p̂ (1 + ν) (1 − 2ν) / ((1 − ν) E); at ν = ½ it is incompressible, and M → ⅔ x³.
[[nodiscard]] inline double layer_compliance(double x, double poisson) {
    if (!(x < detail::endless_wave))
        return 1;
    const double kappa = 3 - 4 * poisson, decay = std::exp(-2 * x);
    // κ sinh 2x − 2x = (κ − 1) sinh 2x + (sinh 2x − 2x): nothing cancels for small x.
    const double numerator =
        -2 * (1 - 2 * poisson) * std::expm1(-4 * x) + 2 * decay * detail::sinh_beyond_linear(2 * x);
    return numerator / (kappa * (1 + decay * decay) + (4 * x * x + kappa * kappa + 1) * decay);
}

/// 1 − M(x), without cancellation. It is 1 for x = 0, and ~ 4x² e⁻²ˣ / κ for large x.
[[nodiscard]] inline double layer_stiffening(double x, double poisson) {
    if (!(x < detail::endless_wave))
        return 0;
    const double kappa = 3 - 4 * poisson, decay = std::exp(-2 * x);
    const double common = 4 * x * x + kappa * kappa + 1;
    return decay * (common + 4 * x + 2 * kappa * decay) / (kappa * (1 + decay * decay) + common * decay);
}

/// The ratio of the pressures on base and surface, p̂_base / p̂ =
///
///     m (m cosh x + x sinh x) / (x² + m² + κ sinh² x),    m = 2 (1 − ν).
///
/// It is 1 for x = 0, since no force is lost, ~ 2 (m/κ) x e⁻ˣ for large x, and never negative.
[[nodiscard]] inline double layer_transfer(double x, double poisson) {
    if (!(x < detail::endless_wave))
        return 0;
    const double kappa = 3 - 4 * poisson, m = 2 * (1 - poisson), decay = std::exp(-x);
    const double squared = decay * decay, rest = -std::expm1(-2 * x);
    return 2 * m * decay * (m * (1 + squared) + x * rest) /
           (4 * (x * x + m * m) * squared + kappa * rest * rest);
}

}}} // namespace tactnet::simulation
