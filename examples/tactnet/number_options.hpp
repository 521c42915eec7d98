#pragma once

// What counts as a number on the command line and in the metadata of weight files: digits, a point and an
// exponent, of a value that the type holds. CLI11 also takes nan, "true" and octal digits, so every option
// that takes a number has one of these checks.

#include <CLI/CLI.hpp>
#if defined(_WIN32) // CLI11 may have included <windows.h>, and these are names of the library
#undef far
#undef near
#undef pascal
#endif

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

/// Decimal digits without leading zeros, which others read as octal. Nothing for other text, or from 2^64 on.
std::optional<std::uint64_t> whole_number_of(std::string_view text);
/// A finite number, decimal. Nothing for other text such as nan and inf, or beyond what a double holds.
std::optional<double> number_of(std::string_view text);

/// Whether it is a share of a whole of which something is left: 0 to below 1.
constexpr bool is_share(double value) {
    return value >= 0 && value < 1;
}

/// Checks for CLI11; both limits are allowed values.
CLI::Validator whole_number(std::uint64_t least,
                            std::uint64_t most = std::numeric_limits<std::uint64_t>::max());
/// A number above 0.
CLI::Validator positive_number();
/// A number from 0 to `most`, which is allowed.
CLI::Validator number_up_to(double most);
/// A number from 0 to below 1.
CLI::Validator share();

/// An option whose value is checked.
template <class Value>
void add_option(CLI::App& command, const std::string& names, Value& value, const CLI::Validator& check,
                const std::string& description) {
    command.add_option(names, value, description)->check(check);
}
