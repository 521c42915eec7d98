#pragma once

// Each hard case compares the library with the exact result and checks that its error is within a bound.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>

namespace hard_cases {

/// The unit of an error and its bound.
enum class unit {
    absolute,
    relative, ///< to the exact result
    ulp       ///< units in the last place of the exact result, in single precision
};

/// One number of a case: exact, by the library, and how far apart they may be.
struct outcome {
    double exact = 0, ours = 0, bound = 0;
};

/// Checks that every error is within its bound; NaN is not.
inline void hold(std::string_view name, unit what, std::span<const outcome> outcomes) {
    REQUIRE_FALSE(outcomes.empty());
    for (const auto& [exact, ours, bound] : outcomes) {
        const int exponent = exact == 0 ? -126 : std::max(std::ilogb(exact), -126);
        const double scale = what == unit::absolute   ? 1
                             : what == unit::relative ? std::abs(exact)
                                                      : std::ldexp(1.0, exponent - 23);
        const double error = ours == exact ? 0 : std::abs(ours - exact) / scale;
        INFO(std::string(name), ": exact ", exact, ", found ", ours);
        CHECK(error <= bound);
    }
}
inline void hold(std::string_view name, unit what, const outcome& one) {
    hold(name, what, std::span(&one, 1));
}

} // namespace hard_cases
