#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

/// What was asked for cannot be done as it was asked: the program ends with status 2 and the sentence.
struct usage_error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Throws usage_error with a sentence that has values in it.
template <class... Values>
[[noreturn]] void refuse(fmt::format_string<Values...> sentence, Values&&... values) {
    throw usage_error(fmt::format(sentence, std::forward<Values>(values)...));
}

/// How the program ends.
enum exit_status : int { success = 0, failed = 1, bad_input = 2, interrupted_by_user = 130 };
