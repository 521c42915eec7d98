#pragma once

// How far a result in floating point may be from the exact one. Every bound is the unit roundoff times the
// number of roundings times the sum of magnitudes that go through them (Higham, "Accuracy and stability of
// numerical algorithms", 2nd edition, chapter 3); none is a number that happened to pass.

#include <cmath>
#include <cstddef>
#include <limits>

namespace support {

/// Half the distance from 1 to the next number: the largest relative error of one rounding.
template <class T>
inline constexpr double unit_roundoff = static_cast<double>(std::numeric_limits<T>::epsilon()) / 2;

/// Bound of the error that `roundings` of relative size `roundoff` in a row make: γ_n = n u / (1 − n u).
[[nodiscard]] inline double accumulated(double roundoff, double roundings) {
    return roundings * roundoff / (1 - roundings * roundoff);
}

/// A number of the reference, how far from it a result may lie, and how far it lies where roundings are
/// independent of each other (layers/deployed_reference.hpp).
struct bounded {
    double value = 0, error = 0, deviation = 0;
};

/// Whether a result lies where it may. NaN is found only where NaN is expected.
[[nodiscard]] inline bool within(double found, const bounded& expected) {
    if (std::isnan(expected.value) || std::isnan(found))
        return std::isnan(expected.value) && std::isnan(found);
    if (std::isinf(expected.value))
        return found == expected.value;
    return std::abs(found - expected.value) <= expected.error + std::numeric_limits<double>::min();
}

} // namespace support
