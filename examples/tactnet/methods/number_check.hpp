#pragma once

#include <CLI/CLI.hpp>

#include <cmath>
#include <string>

/// For options that take a number above 0: no infinity, and not what is no number.
inline CLI::Validator above_zero() {
    return CLI::Validator(
        [](const std::string& text) -> std::string {
            double value = 0;
            if (CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0)
                return {};
            return "expected a number above 0, found '" + text + "'";
        },
        "", "above_zero");
}
