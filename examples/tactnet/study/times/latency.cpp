#include "study/times/latency.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <stopwatch.hpp>
#include <vector>

#if defined(__linux__)
#include <sched.h>
#endif

namespace {

/// Microseconds of each of many calls, sorted.
template <class Work>
std::vector<double> times_of(const Work& work) {
    constexpr double enough = 0.4; // seconds
    constexpr std::size_t fewest = 5, most = 20'000;
    for (std::size_t i = 0; i < 3; ++i) // caches and branch predictors
        work();
    std::vector<double> times;
    for (double all = 0; times.size() < fewest || (all < enough && times.size() < most);) {
        const stopwatch watch;
        work();
        times.push_back(1e6 * watch.seconds());
        all += 1e-6 * times.back();
    }
    std::sort(times.begin(), times.end());
    return times;
}

double quantile(const std::vector<double>& sorted, double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
    return sorted[std::max<std::size_t>(rank, 1) - 1];
}

/// Steps of a generator, each of which waits for the one before; no memory.
void spin(std::uint64_t steps) {
    std::uint64_t x = steps | 1U;
    for (std::uint64_t i = 0; i < steps; ++i)
        x = x * 6364136223846793005U + 1442695040888963407U;
    static std::atomic<std::uint64_t> kept; // or a compiler would leave the loop out
    kept.store(x, std::memory_order_relaxed);
}

double jitter_over(double microseconds) {
    constexpr std::uint64_t tried = 100'000;
    const double each = median_microseconds([] { spin(tried); }) / static_cast<double>(tried);
    const auto steps = static_cast<std::uint64_t>(std::max(1.0, microseconds / each));
    const std::vector<double> times = times_of([&] { spin(steps); });
    return quantile(times, 0.99) / quantile(times, 0.5);
}

} // namespace

#if defined(__linux__)
pinned::pinned() {
    cpu_set_t before, one;
    const int core = sched_getcpu();
    if (core < 0 || sched_getaffinity(0, sizeof(before), &before) != 0)
        return;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(core), &one);
    if (sched_setaffinity(0, sizeof(one), &one) == 0)
        free_ = [before] { sched_setaffinity(0, sizeof(before), &before); };
}
#else
pinned::pinned() = default;
#endif
pinned::~pinned() {
    if (free_)
        free_();
}

frame_latency measure_latency(const frame_work& work, std::size_t together) {
    const std::vector<double> times = times_of([&] { work(1); });
    frame_latency found;
    found.median = quantile(times, 0.5);
    found.p99 = quantile(times, 0.99);
    found.jitter = jitter_over(found.median);
    found.in_batch = median_microseconds([&] { work(together); }) / static_cast<double>(together);
    return found;
}
