#pragma once

// What each hard case states: the exact result, what a plain implementation gives, what ours gives, and the
// bound that our error is held to. With TACTNET_HARD_CASES=FILE in the environment every case adds a line of
// JSON to that file; docs/numerics.md is made of such files (numerics_page.cmake).

#include <span>
#include <string_view>

namespace hard_cases {

/// In what an error is told.
enum class unit {
    absolute,
    relative, ///< to the exact result
    ulp       ///< units in the last place of the exact result, in single precision
};

/// One number of a case. The bound is in the case's unit.
struct outcome {
    double exact = 0, plain = 0, ours = 0, bound = 0;
};

/// Checks that every error of ours is within its bound. The line tells the number where the plain
/// implementation is worst, and the largest part of a bound that an error of ours takes.
void hold(std::string_view topic, std::string_view name, unit what, std::span<const outcome> outcomes);
void hold(std::string_view topic, std::string_view name, unit what, const outcome& one);

/// A case that has no right result: checks that it is told. `plain` is what a plain implementation gives
/// without a word, `how` what ours says.
void tell(std::string_view topic, std::string_view name, double plain, bool told, std::string_view how);

/// What is not stable, with its number: `ours` is how far it goes, `reason` why.
void limit(std::string_view topic, std::string_view name, double plain, double ours, std::string_view reason);

} // namespace hard_cases
