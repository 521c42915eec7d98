#include <tactnet/runtime/thread_pool.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <fstream>
#include <memory>
#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#if defined(__linux__)
#include <sys/resource.h>
#include <unistd.h>
#endif

using namespace tactnet;

TEST_CASE("thread_pool: every index once, for any count and number of threads") {
    for (const std::size_t threads : {0u, 1u, 2u, 3u, 5u, 8u}) {
        thread_pool pool(threads);
        CHECK(pool.threads() == std::max<std::size_t>(threads, 1));
        for (const std::size_t count : {0u, 1u, 2u, 3u, 4u, 7u, 64u, 1000u}) {
            std::vector<std::atomic<int>> visits(count);
            pool.for_each(count, [&](std::size_t i) { ++visits[i]; });
            CHECK(std::all_of(visits.begin(), visits.end(), [](const auto& n) { return n == 1; }));
        }
    }
}

TEST_CASE("thread_pool: a call within a call, or of a second thread, is an error and does not hang") {
    thread_pool pool(3);
    for (std::size_t caller = 0; caller < 3; ++caller)
        CHECK_THROWS_WITH_AS(pool.on_each_thread([&](thread_pool::share part) {
            if (part.index == caller)
                pool.for_each(2, [](std::size_t) {});
        }),
                             doctest::Contains("thread_pool: expected one call at a time"), std::logic_error);
    std::atomic<bool> inside{false}, tried{false};
    std::thread other([&] {
        while (!inside)
            std::this_thread::yield();
        CHECK_THROWS_AS(pool.on_each_thread([](thread_pool::share) {}), std::logic_error);
        tried = true;
    });
    pool.on_each_thread([&](thread_pool::share) {
        inside = true;
        while (!tried)
            std::this_thread::yield();
    });
    other.join();
    std::atomic<int> calls{0}; // it works as before
    pool.for_each(100, [&](std::size_t) { ++calls; });
    CHECK(calls == 100);
}

TEST_CASE("thread_pool: shares follow each other and are equal but for one") {
    for (const std::size_t threads : {1u, 2u, 3u, 5u}) {
        for (const std::size_t count : {0u, 1u, 4u, 5u, 17u, 1000u}) {
            std::size_t next = 0;
            for (std::size_t index = 0; index < threads; ++index) {
                const thread_pool::share part{index, threads};
                CHECK(part.begin(count) == next);
                CHECK(part.end(count) >= part.begin(count));
                CHECK(part.end(count) - part.begin(count) <= count / threads + 1);
                next = part.end(count);
            }
            CHECK(next == count);
        }
    }
}

TEST_CASE("thread_pool: on_each_thread gives every thread a share of its own, always the same one") {
    thread_pool pool(3);
    std::vector<std::thread::id> first(3), second(3);
    pool.on_each_thread([&](thread_pool::share part) {
        CHECK_UNARY(part.threads == 3);
        first[part.index] = std::this_thread::get_id();
    });
    pool.on_each_thread([&](thread_pool::share part) { second[part.index] = std::this_thread::get_id(); });
    CHECK(first == second);
    CHECK(first[0] == std::this_thread::get_id());
    CHECK(first[1] != first[0]);
    CHECK(first[1] != first[2]);
}

TEST_CASE("thread_pool: many rounds in a row, each seeing what the one before has written") {
    thread_pool pool(3);
    std::vector<std::size_t> values(50);
    for (std::size_t round = 0; round < 5000; ++round) {
        const std::vector<std::size_t> before = values;
        pool.for_each(values.size(), [&](std::size_t i) { values[i] = before[(i + 1) % before.size()] + 1; });
    }
    CHECK(std::all_of(values.begin(), values.end(), [](std::size_t v) { return v == 5000; }));
}

TEST_CASE("thread_pool: what a body throws reaches the caller, of the lowest share, once all have ended") {
    for (const std::size_t threads : {1u, 2u, 3u, 5u}) {
        thread_pool pool(threads);
        for (std::size_t first = 0; first < threads; ++first)
            for (int round = 0; round < 20; ++round) {
                std::atomic<std::size_t> ended{0};
                std::size_t caught = threads;
                try {
                    pool.on_each_thread([&](thread_pool::share part) {
                        ++ended;
                        if (part.index >= first)
                            throw part.index;
                    });
                } catch (std::size_t index) {
                    caught = index;
                }
                CHECK(caught == first);
                CHECK(ended == threads);
                // And the pool is as good as new.
                std::vector<std::atomic<int>> visits(50);
                pool.for_each(visits.size(), [&](std::size_t i) { ++visits[i]; });
                CHECK(std::all_of(visits.begin(), visits.end(), [](const auto& n) { return n == 1; }));
            }
        CHECK_THROWS_AS(pool.for_each(64,
                                      [](std::size_t i) {
                                          if (i == 63)
                                              throw std::bad_alloc();
                                      }),
                        std::bad_alloc);
    }
}

TEST_CASE("thread_pool: sleeping threads wake") {
    thread_pool pool(3);
    std::atomic<int> sum{0};
    for (int round = 0; round < 3; ++round) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        pool.for_each(10, [&](std::size_t) { ++sum; });
    }
    CHECK(sum == 30);
}

TEST_CASE("thread_pool: made and left in a row, used or not") {
    std::atomic<int> sum{0};
    for (int i = 0; i < 200; ++i) {
        thread_pool pool(4);
        if (i % 2 == 0)
            pool.for_each(8, [&](std::size_t) { ++sum; });
    }
    CHECK(sum == 800);
}

TEST_CASE("thread_pool: destroyed during a call of another thread, it waits for the call") {
    for (int round = 0; round < 30; ++round) {
        const bool throws = round % 2 == 1;
        std::atomic<int> inside{0}, ended{0}, caught{0};
        auto pool = std::make_unique<thread_pool>(3);
        std::thread caller([&, used = pool.get()] {
            try {
                used->on_each_thread([&](thread_pool::share) {
                    ++inside;
                    std::this_thread::sleep_for(std::chrono::microseconds(500));
                    ++ended;
                    if (throws)
                        throw std::bad_alloc();
                });
            } catch (const std::bad_alloc&) {
                ++caught;
            }
        });
        while (inside == 0)
            std::this_thread::yield();
        pool.reset();
        CHECK(ended == 3);
        caller.join();
        CHECK(caught == int{throws});
    }
}

// Sanitizers need memory of their own for every thread, and end the program where they get none.
#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_CASE("thread_pool: a thread that cannot start is an error, and those before it are ended") {
    // Memory for a few stacks more, and not for all of them.
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    REQUIRE(pages > 0);
    const std::size_t used = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    rlimit before{};
    REQUIRE(getrlimit(RLIMIT_AS, &before) == 0);
    rlimit tight = before;
    tight.rlim_cur = used + (std::size_t{64} << 20);
    REQUIRE(setrlimit(RLIMIT_AS, &tight) == 0);
    bool refused = false;
    try {
        thread_pool pool(256);
    } catch (const std::system_error&) {
        refused = true;
    }
    REQUIRE(setrlimit(RLIMIT_AS, &before) == 0);
    CHECK(refused);
    thread_pool after(4); // nothing is left behind that would be in the way
    std::atomic<int> sum{0};
    after.for_each(100, [&](std::size_t) { ++sum; });
    CHECK(sum == 100);
}
#endif

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
