#pragma once

#include "methods/method.hpp"

#include <stopwatch.hpp>

/// Microseconds a frame on one thread: the median of repeated runs.
struct frame_times {
    double alone = 0;    ///< one frame at a time
    double in_batch = 0; ///< as many at once as pass together
};

inline frame_times time_frames(const method& what) {
    const frame_work work = what.make_work();
    const std::size_t together = what.frames_together();
    return {median_microseconds([&] { work(1); }),
            median_microseconds([&] { work(together); }) / static_cast<double>(together)};
}
