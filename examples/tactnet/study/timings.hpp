#pragma once

// How long a method takes for a frame, and how much of that is this machine's own restlessness; and a file of
// such times, a JSON line each, by method, size, processor and program: times of two machines are not mixed.

#include "files/line_file.hpp"
#include "methods/method.hpp"

#include <map>

/// In microseconds per frame, on one core.
struct frame_latency {
    double median = 0;   ///< of single frames, one after the other
    double p99 = 0;      ///< 99 of 100 take no longer
    double in_batch = 0; ///< as many at once as pass together
    /// What `p99` is by `median` for a loop in registers that takes as long: the machine's part of it.
    double jitter = 1;
};

/// Keeps the calling thread, and those that it starts, on the core where it is, if the system does that.
void stay_on_this_core();

/// Takes about a second, or five frames where they take longer; with a clock that is too slow, as long as
/// some 10¹¹ multiply-adds take.
frame_latency measure_latency(const method& what, std::size_t bits);

class timing_list {
public:
    /// Reads what there is. Throws tactnet::file_error.
    explicit timing_list(const std::filesystem::path& path);

    /// Reads what other programs have added since. Throws tactnet::file_error.
    void read_on();
    /// With weights of so many bits, by this program on this machine, or nothing.
    const frame_latency* find(const method& what, std::size_t bits) const;
    /// From now on `find` has what the program that wrote the last line measured, perhaps on another machine.
    void show_latest();
    bool others() const;
    /// Whose times are shown: processor, machine, compiler, version and instruction set.
    const tactnet::file_metadata& shown() const { return shown_; }
    void add(const method& what, std::size_t bits, const frame_latency& found);

private:
    line_file file_;
    tactnet::file_metadata shown_, latest_; ///< `latest_` has the last line of the file
    std::map<tactnet::file_metadata, frame_latency> all_;
};
