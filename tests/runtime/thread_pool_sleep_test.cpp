#include <tactnet/runtime/thread_pool.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <cstddef>

using namespace tactnet;

TEST_CASE("thread_pool: a worker that is about to sleep hears of the next call, and of the end") {
    std::atomic<std::size_t> calls{0}, pause{0};
    for (std::size_t pools = 0; pools < 300; ++pools) {
        thread_pool pool(2);
        for (std::size_t round = 0; round < 4; ++round) {
            for (std::size_t spin = 0; spin < (pools * 4 + round) * 37 % 9001; ++spin)
                ++pause; // about as long as a worker spins before it sleeps
            pool.for_each(2, [&](std::size_t) { ++calls; });
        }
    }
    CHECK(calls == 2400);
}
