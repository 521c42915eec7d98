#pragma once

// Wall-clock time.

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

class stopwatch {
public:
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// The median of nine timings of at least 10 ms each, of fewer where they take half a second together, in
/// microseconds a call. At most eleven times `most_calls` calls, so that a clock that stands still, runs
/// backwards or is slow ends as well.
template <class Work>
double median_microseconds(const Work& work, std::size_t most_calls = std::size_t{1} << 17) {
    constexpr double shortest = 0.01, enough = 0.5;
    constexpr std::size_t most = 9, clock_must_have_moved = 1024;
    const auto seconds_for = [&](std::size_t calls) {
        const stopwatch watch;
        for (std::size_t i = 0; i < calls; ++i)
            work();
        return watch.seconds();
    };
    std::size_t calls = 1;
    while (calls < most_calls) {
        const double seconds = seconds_for(calls);
        if (seconds >= shortest || (seconds <= 0 && calls >= clock_must_have_moved))
            break;
        calls = std::min(2 * calls, most_calls);
    }
    std::vector<double> times;
    double all = 0;
    while (times.empty() || (times.size() < most && all < enough)) {
        times.push_back(seconds_for(calls));
        all += times.back();
    }
    std::sort(times.begin(), times.end());
    return 1e6 * times[times.size() / 2] / static_cast<double>(calls);
}
