#pragma once

// The one way to the standard streams. Results that cannot be written are an error; messages and progress
// that cannot be shown are dropped, since nobody is there to read them and the work is worth more.

#include <fmt/format.h>

#include <standard_output.hpp>
#include <string_view>
#include <utility>

/// To be called first of all. Closed streams are taken up, so that no file that is opened later gets their
/// numbers and with them what is printed; a pipe that nobody reads and a file beyond the allowed size become
/// errors of the writing in place of the end.
void prepare_standard_streams() noexcept;

/// To the standard error, at once, if it can be.
void show(std::string_view text) noexcept;

/// The same for a sentence with values in it.
template <class... Values>
void tell(fmt::format_string<Values...> sentence, Values&&... values) noexcept {
    try {
        show(fmt::format(sentence, std::forward<Values>(values)...));
    } catch (...) { // no memory for it
    }
}
