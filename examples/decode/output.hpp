#pragma once

#include <string_view>

// Standard output, where a full disk or a reader that has gone is an error and not silence.

/// Keeps the process alive when the reader of its output has gone: writing then fails instead.
void survive_closed_output();
/// Throws std::system_error.
void print(std::string_view text);
/// What the system has kept back so far. Throws std::system_error.
void flush_output();
