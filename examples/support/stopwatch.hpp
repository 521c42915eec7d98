#pragma once

// Wall-clock time.

#include <algorithm>
#include <array>
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

/// The median of at most nine timings of one call each, fewer where they take half a second together, in
/// microseconds.
template <class Work>
double brief_median_microseconds(const Work& work) {
    constexpr double enough = 0.5;
    std::vector<double> times;
    double all = 0;
    while (times.empty() || (times.size() < 9 && all < enough)) {
        const stopwatch watch;
        work();
        times.push_back(watch.seconds());
        all += times.back();
    }
    std::sort(times.begin(), times.end());
    return 1e6 * times[times.size() / 2];
}

/// The median of nine timings of at least 10 ms each, in microseconds a call.
template <class Work>
double median_microseconds(Work&& work) {
    const auto seconds_for = [&](std::size_t calls) {
        const stopwatch watch;
        for (std::size_t i = 0; i < calls; ++i)
            work();
        return watch.seconds();
    };
    std::size_t calls = 1;
    while (seconds_for(calls) < 0.01)
        calls *= 2;
    std::array<double, 9> times{};
    for (double& time : times)
        time = seconds_for(calls) * 1e6 / static_cast<double>(calls);
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
}
