#pragma once

#include <string>
#include <string_view>

// Standard output, where a full disk or a reader that has gone is an error and not silence; and text that is
// fit for it.

/// At the beginning of a program: writing to a reader that has gone, or to a file at its limit, then fails
/// and is reported, where it would end the program without a word (SIGPIPE, SIGXFSZ).
void ignore_output_signals() noexcept;

/// To standard output. Throws tactnet::file_error when it does not take it.
void print(std::string_view text);

/// Writes what the system has buffered so far; for the end of a program, before it reports success. Throws
/// tactnet::file_error unless all that was written to standard output has been taken.
void finish_output();

/// Text that may hold the name of a file, or what a file says of itself, fit for one line of a terminal:
/// control characters, those that turn the direction of writing and bytes that are not UTF-8 become \xNN. All
/// that the program prints of such text passes through here.
std::string printable(std::string_view text);
