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

/// Seconds per call of body(), the mean of `repeats` calls.
template <class Body>
[[nodiscard]] double seconds_of(Body&& body, std::size_t repeats) {
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t r = 0; r < repeats; ++r)
        body();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() /
           static_cast<double>(repeats);
}
/// How often to repeat what takes less than 100 µs.
template <class Body>
[[nodiscard]] std::size_t repeats_of(Body&& body) {
    double least = seconds_of(body, 1);
    for (int i = 0; i < 20; ++i)
        least = std::min(least, seconds_of(body, 1));
    return 1 + static_cast<std::size_t>(1e-4 / least);
}
[[nodiscard]] inline double quantile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Medians in seconds; of the rounds' ratios, peer ÷ own, the median and the quartiles.
struct race_result {
    double own, peer, ratio, lower, upper;
};
/// Times both in turns, 101 rounds.
template <class Own, class Peer>
[[nodiscard]] race_result race(Own&& own, Peer&& peer) {
    const std::size_t own_repeats = repeats_of(own), peer_repeats = repeats_of(peer);
    std::vector<double> ours, theirs, ratios;
    for (int round = 0; round < 101; ++round) {
        ours.push_back(seconds_of(own, own_repeats));
        theirs.push_back(seconds_of(peer, peer_repeats));
        ratios.push_back(theirs.back() / ours.back());
    }
    return {quantile(ours, 0.5), quantile(theirs, 0.5), quantile(ratios, 0.5), quantile(ratios, 0.25),
            quantile(ratios, 0.75)};
}

} // namespace benchmark
