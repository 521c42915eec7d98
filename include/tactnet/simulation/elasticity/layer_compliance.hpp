#pragma once

#include <tactnet/detail/config.hpp>

#include <cmath>

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

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

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
