#pragma once

// What counts as a number on the command line and in what weight files say of their training: digits, a point
// and an exponent, of a value that the type holds. Every option that takes a number checks it by one of
// these.

#include <CLI/CLI.hpp>

#include <cstdint>
#include <optional>
#include <string_view>

/// Decimal digits without leading zeros, which others read as octal, or hexadecimal ones after 0x. Nothing
/// for other text, or from 2^64 on.
std::optional<std::uint64_t> whole_number_of(std::string_view text);
/// A finite number, decimal. Nothing for other text such as nan and inf, or beyond what a double holds.
std::optional<double> number_of(std::string_view text);

/// Whether it is a share of a whole of which something is left: 0 to below 1.
constexpr bool is_share(double value) {
    return value >= 0 && value < 1;
}

/// Checks for CLI11; both limits are allowed values.
CLI::Validator whole_number(std::uint64_t least, std::uint64_t most);
/// Any whole number that 64 bits hold.
CLI::Validator seed();
/// A number above 0.
CLI::Validator positive_number();
/// A number from 0 to below 1.
CLI::Validator share();
