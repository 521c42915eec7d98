#pragma once

// How long a method takes for a frame, and how far this machine's own restlessness is in it.

#include "methods/method.hpp"

#include <cstddef>
#include <functional>

/// In microseconds a frame, on one core.
struct frame_latency {
    double median = 0;   ///< of single frames, one after the other
    double p99 = 0;      ///< 99 of 100 take no longer
    double in_batch = 0; ///< as many at once as pass together
    /// What `p99` is by `median` for a loop in registers that takes as long: what of it is the machine's.
    double jitter = 1;
};

/// Keeps the calling thread on the core where it is. Where the system does not let it, it stays free.
class pinned {
public:
    pinned();
    pinned(const pinned&) = delete;
    pinned& operator=(const pinned&) = delete;
    ~pinned();

private:
    std::function<void()> free_; ///< lets it go where it could before
};

/// Takes about a second, or five frames where they take longer.
frame_latency measure_latency(const frame_work& work, std::size_t together);
