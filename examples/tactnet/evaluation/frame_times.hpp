#pragma once

#include "methods/method.hpp"

#include <cstddef>
#include <stopwatch.hpp>

/// Microseconds a frame on one thread: the median of repeated runs.
struct frame_times {
    double alone = 0;    ///< one frame at a time
    double in_batch = 0; ///< as many at once as pass together
};

/// With weights of 8 bits, or of 32.
inline frame_times time_frames(const method& what, std::size_t bits) {
    const frame_work work = what.make_work(bits);
    const std::size_t together = what.frames_together();
    return {median_microseconds([&] { work(1); }),
            median_microseconds([&] { work(together); }) / static_cast<double>(together)};
}
