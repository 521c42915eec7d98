#pragma once

#include <stdexcept>

/// What was asked for cannot be done as it was asked: the program ends with status 2 and the sentence.
struct usage_error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// How the program ends.
enum exit_status : int { success = 0, failed = 1, bad_input = 2, interrupted_by_user = 130 };
