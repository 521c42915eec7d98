#pragma once

// How the program ends, and the one way to the standard streams. Results that cannot be written are an error;
// messages and progress that cannot be shown are dropped, since there is no reader and the work is worth
// more.

#include <fmt/format.h>

#include <cstddef>
#include <functional>
#include <standard_output.hpp>
#include <stdexcept>
#include <stopwatch.hpp>
#include <string>
#include <string_view>
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

/// To be called first. Opens standard streams that are closed, so that no file opened later gets what is
/// printed. Writing to a pipe that nobody reads, or beyond the allowed size of a file, becomes an error
/// instead of a signal that ends the program.
void prepare_standard_streams() noexcept;

/// To the standard error, at once, if it can be.
void show(std::string_view text) noexcept;

/// A long text, of what a hostile file holds, without its middle: at most 1000 bytes.
std::string shortened(std::string text);

/// Shows a sentence with values in it, shortened.
template <class... Values>
void tell(fmt::format_string<Values...> sentence, Values&&... values) noexcept {
    try {
        show(shortened(fmt::format(sentence, std::forward<Values>(values)...)));
    } catch (...) { // no memory for it
    }
}

/// Reports to a waiting user: on one line of a terminal, as a line every few seconds elsewhere.
class progress {
public:
    progress();
    ~progress() { end_line(); }
    /// Shows the text if it is time to; the last one of all should be `final`.
    void show(const std::string& text, bool final = false);
    /// Ends the line, if there is one, so that something else can be written.
    void end_line();

private:
    bool terminal_, open_ = false;
    double next_ = 0;
    std::size_t width_ = 0;
    stopwatch watch_;
};

/// "12 s", "3 min 20 s", "2 h 5 min".
std::string duration_text(double seconds);
/// "3 min 20 s left", after so many seconds in which so much was done.
std::string time_left(double seconds, std::size_t done, std::size_t left);

/// Asks until it is `ready`, and prints once what is waited for. False if interrupted.
bool wait_until(const std::function<bool()>& ready, const std::string& sentence);
