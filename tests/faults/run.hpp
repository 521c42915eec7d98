#pragma once

// A program run under conditions that it did not ask for, and how it ended.

#include <chrono>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace faults {

namespace fs = std::filesystem;

/// What one of the three standard streams leads to.
enum class stream {
    usual,  ///< nothing to read; what is written is kept
    closed, ///< no stream at all
    full,   ///< a disk without room
    broken, ///< a pipe without a reader
    null    ///< the null device
};

struct conditions {
    stream in = stream::usual, out = stream::usual, error = stream::usual;
    std::string input; ///< what comes from the standard input, if that is as usual
    std::vector<std::pair<int, unsigned long>> limits{}; ///< of setrlimit
    bool limited_user = false;                           ///< one that no limit is waived for
    int signal = 0;                                      ///< sent after a while, if it still runs
    std::chrono::microseconds after{0};
    std::string clock;    ///< a mode of clock_library.cpp; empty for the system's
    bool pictures = true; ///< whether gnuplot is found
    std::chrono::seconds patience{60};
};

/// Drawing pictures takes most of the time of a training.
inline const conditions without_pictures = [] {
    conditions usual;
    usual.pictures = false;
    return usual;
}();

struct ending {
    int status = -1; ///< of an exit; a signal's number is in `signal`
    int signal = 0;
    bool hung = false;
    std::string out, error;
    std::chrono::microseconds took{0};

    bool done() const { return orderly() && status == 0; }
    /// A sanitizer's report has an exit status of its own choice.
    bool orderly() const {
        return !hung && signal == 0 && status >= 0 && status <= 2 &&
               error.find("Sanitizer") == std::string::npos &&
               error.find("runtime error:") == std::string::npos;
    }
    std::string text() const;
};

using words = std::vector<std::string>;

/// Runs words[0] with the other words in a folder. Throws std::system_error when there can be no child.
ending run(const words& command, const fs::path& folder, const conditions& under = {});

/// The same as a line for a shell.
std::string shell_line(const words& command, const fs::path& folder, const conditions& under = {});

/// All bytes of a file; empty if there is none.
std::string bytes_of(const fs::path& file);
void write_bytes(const fs::path& file, const std::string& bytes);

} // namespace faults
