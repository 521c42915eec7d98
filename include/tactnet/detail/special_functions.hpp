#pragma once

#include <tactnet/detail/arithmetic.hpp>

#include <cstdint>
#include <limits>

// Functions of activations in double precision, constexpr, since tables of networks in 8 bits are also made
// while compiling. Relative
// errors are below 10⁻¹².

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// eˣ: x = n · ln 2 + r, the Taylor series of eʳ, and n added to the exponent. 0 where results would be
/// subnormal.
[[nodiscard]] constexpr double exponential(double x) {
    constexpr double lowest = -708, highest = 709.75;
    if (!(x >= lowest))
        return x < lowest ? 0 : x;
    if (x > highest)
        return std::numeric_limits<double>::infinity();
    constexpr double ln2_high = 0x1.62e42fee00000p-1, ln2_low = 0x1.a39ef35793c76p-33;
    const double quotient = x * 0x1.71547652b82fep0;
    const auto n = static_cast<std::int64_t>(quotient < 0 ? quotient - 0.5 : quotient + 0.5);
    const auto count = static_cast<double>(n);
    const double r = (x - count * ln2_high) - count * ln2_low;
    double series = 1;
    for (int term = 14; term > 0; --term)
        series = 1 + series * r / term;
    // Two factors, since the largest results have n = 1024, and 2¹⁰²⁴ is not a double.
    const auto power = [](std::int64_t exponent) {
        return bits_as<double>(static_cast<std::uint64_t>(exponent + 1023) << 52U);
    };
    return series * power(n / 2) * power(n - n / 2);
}

/// tanh x, as the quotient of two series near zero, where 1 − 2 ÷ (e²ˣ + 1) would cancel.
[[nodiscard]] constexpr double hyperbolic_tangent(double x) {
    const double size = x < 0 ? -x : x;
    if (size < 0.5) {
        double odd = 1, even = 1;
        for (int term = 20; term > 1; term -= 2) {
            odd = 1 + odd * (x * x) / (term * (term + 1));
            even = 1 + even * (x * x) / (term * (term - 1));
        }
        return x * odd / even;
    }
    const double far = 1 - 2 / (exponential(2 * size) + 1);
    return x < 0 ? -far : far;
}

/// log(1 + x) for 0 ≤ x ≤ 1, by the series of 2 artanh(x ÷ (2 + x)).
[[nodiscard]] constexpr double log_one_plus(double x) {
    const double s = x / (2 + x);
    double series = 0;
    for (int term = 39; term > 0; term -= 2)
        series = series * (s * s) + 1.0 / term;
    return 2 * s * series;
}

/// The density of the standard normal distribution at x.
[[nodiscard]] constexpr double normal_density(double x) {
    constexpr double of_zero = 0.39894228040143267794;
    if (!(x * x <= 1600))
        return x == x ? 0 : x;
    // The square of the first 24 bits is exact; rounding the whole square would cost digits of the result.
    const auto first = static_cast<double>(static_cast<float>(x));
    return of_zero * exponential(-0.5 * first * first) * exponential(-0.5 * (x - first) * (x + first));
}

/// The probability that a standard normal variable is below −x, for x ≥ 0: a series up to 1, a continued
/// fraction (Laplace) above it.
[[nodiscard]] constexpr double normal_tail(double x) {
    if (!(x <= 40))
        return x > 40 ? 0 : x;
    if (x < 1) {
        double series = 1;
        for (int term = 49; term > 1; term -= 2)
            series = 1 + series * (x * x) / term;
        return 0.5 - normal_density(x) * x * series;
    }
    // So many terms leave less than 2⁻⁵³ of the result; a table of bytes is made while compiling.
    double fraction = x;
    for (int term = 10 + static_cast<int>(400 / (x * x)); term > 0; --term)
        fraction = x + term / fraction;
    return normal_density(x) / fraction;
}

}}} // namespace tactnet::detail
