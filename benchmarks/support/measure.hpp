#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <vector>

// Timing that can be trusted on a shared machine: several rounds, of which the fastest shows what the code
// can do and the median what this machine gave it.

namespace benchmark {

struct timing {
    double fastest = 0; ///< seconds
    double median = 0;  ///< seconds
};

/// Runs body() once to warm up and then `rounds` times.
template <class Body>
[[nodiscard]] timing time_rounds(std::size_t rounds, Body&& body) {
    body();
    std::vector<double> seconds;
    for (std::size_t r = 0; r < rounds; ++r) {
        const auto start = std::chrono::steady_clock::now();
        body();
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(seconds.begin(), seconds.end());
    return {seconds.front(), seconds[seconds.size() / 2]};
}

} // namespace benchmark
