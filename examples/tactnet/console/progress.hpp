#pragma once

// Reports to a waiting user: on one line of a terminal, as a line every few seconds elsewhere. It goes to the
// standard error, so that results can be redirected.

#include <cstddef>
#include <functional>
#include <stopwatch.hpp>
#include <string>

class progress {
public:
    progress();
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

/// Asks until it is `ready`, and prints once what is waited for. False if interrupted.
bool wait_until(const std::function<bool()>& ready, const std::string& sentence);
