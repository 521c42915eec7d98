#pragma once

// Each hard case compares the library with the exact result and with a naive implementation, and checks that
// the library's error is within its bound. If TACTNET_HARD_CASES=FILE is in the environment, each case
// appends a line of JSON to that file; numerics_page.cmake makes docs/verify/numerics.md and
// docs/verify/numerics/ from such files.

#include <span>
#include <string_view>

namespace hard_cases {

/// The unit of an error.
enum class unit {
    absolute,
    relative, ///< to the exact result
    ulp       ///< units in the last place of the exact result, in single precision
};

/// One number of a case: exact, by the naive implementation, by the library. The bound is in the case's unit.
struct outcome {
    double exact = 0, plain = 0, ours = 0, bound = 0;
};

/// Checks that every error of the library is within its bound. The line shows the number at which the naive
/// implementation is worst, and the library's error that takes the largest part of its bound.
void hold(std::string_view topic, std::string_view name, unit what, std::span<const outcome> outcomes);
void hold(std::string_view topic, std::string_view name, unit what, const outcome& one);

/// A case without a correct result: checks that the library reports it. `plain` is what a naive
/// implementation returns silently, `how` the library's report.
void reported(std::string_view topic, std::string_view name, double plain, bool is_reported,
              std::string_view how);

/// A limit of numerical stability: `ours` measures it, `reason` explains it.
void limit(std::string_view topic, std::string_view name, double plain, double ours, std::string_view reason);

} // namespace hard_cases
