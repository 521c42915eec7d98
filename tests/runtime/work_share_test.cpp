#include <tactnet/runtime/work_share.hpp>

#include <doctest/doctest.h>

#include <cstddef>

using namespace tactnet;

TEST_CASE("work_share: shares follow each other, hold everything, and differ by one at most") {
    for (std::size_t threads = 1; threads < 9; ++threads)
        for (std::size_t count = 0; count < 40; ++count) {
            std::size_t done = 0, wrong = 0;
            for (std::size_t index = 0; index < threads; ++index) {
                const work_share share{index, threads};
                const std::size_t size = share.end(count) - share.begin(count);
                wrong += share.begin(count) != done || size < count / threads || size > count / threads + 1;
                done = share.end(count);
            }
            CAPTURE(threads);
            CAPTURE(count);
            CHECK(wrong == 0);
            CHECK(done == count);
        }
}

TEST_CASE("work_share: all of the work, unless something else is said") {
    static_assert(work_share{}.begin(7) == 0 && work_share{}.end(7) == 7);
}
