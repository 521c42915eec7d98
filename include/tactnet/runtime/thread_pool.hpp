#pragma once

#include <tactnet/detail/arithmetic.hpp>

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Threads that divide work into equal, fixed shares, for one caller at a time. The shares depend on the
/// counts alone and nothing is reduced across them, so results do not depend on timing. A pool of one thread
/// starts none.
class thread_pool {
public:
    /// Throws std::system_error if the system refuses a thread, after ending those that already run.
    explicit thread_pool(std::size_t threads = 1) : thread_pool(without_workers{}, threads) {
        if (threads_ > 1)
            problems_.resize(threads_); // here, since an exception may mean that memory is exhausted
        workers_.reserve(threads_ - 1);
        for (std::size_t index = 1; index < threads_; ++index)
            workers_.emplace_back([this, index] { work(index); });
    }
    thread_pool(const thread_pool&) = delete;
    thread_pool& operator=(const thread_pool&) = delete;
    /// Waits for a call that another thread is in. No call may begin meanwhile.
    ~thread_pool() {
        wait_until_busy_are(0);
        call_ = nullptr;
        announce();
        for (std::thread& worker : workers_)
            worker.join();
    }

    [[nodiscard]] std::size_t threads() const { return threads_; }

    using share = work_share;

    /// Calls body(share) on each thread. If bodies throw, the other shares still run to their ends, then the
    /// exception of the lowest share is rethrown, so that this does not depend on timing either. The pool
    /// stays usable; what the bodies wrote is in an unspecified state. Throws std::logic_error while the pool
    /// of several threads is in a call already: of a body, or of another thread.
    template <class Body>
    void on_each_thread(const Body& body) {
        share_out(code_of<Body>, &body);
    }
    /// Calls body(share) as on_each_thread does. If `count` is 1, the calling thread runs body alone.
    template <class Body>
    void on_each_share(std::size_t count, const Body& body) {
        if (count == 1)
            code_of<Body>(&body, share{0, 1});
        else
            on_each_thread(body);
    }
    /// Calls body(i) for 0 … count − 1. An exception ends its own share only, and is rethrown as above.
    template <class Body>
    void for_each(std::size_t count, const Body& body) {
        on_each_share(count, [&](share part) {
            for (std::size_t i = part.begin(count); i < part.end(count); ++i)
                body(i);
        });
    }

private:
    // A delegated constructor: once it has returned, the destructor cleans up whatever the public one throws.
    struct without_workers {};
    thread_pool(without_workers, std::size_t threads) : threads_(threads > 0 ? threads : 1) {}

    // The one copy of a body's code. Compilers would otherwise inline it three times: for the calling thread,
    // for the workers and for a pool of one.
    template <class Body>
    [[gnu::noinline]] static void code_of(const void* body, share part) {
        (*static_cast<const Body*>(body))(part);
    }

    [[gnu::noinline]] void share_out(void (*code)(const void*, share), const void* body) {
        if (threads_ == 1)
            return code(body, share{0, 1});
        if (std::size_t idle = 0; !busy_.compare_exchange_strong(idle, threads_, std::memory_order_acquire))
            throw_in_use();
        body_ = body;
        call_ = code;
        announce();
        try {
            code(body, share{0, threads_});
        } catch (...) { // the workers still use the body
            note_problem(0);
        }
        wait_until_busy_are(1);
        const std::exception_ptr problem =
            failed_.load(std::memory_order_relaxed) ? first_problem() : nullptr;
        busy_.store(0, std::memory_order_release); // from here on the pool may be destroyed
        if (problem)
            std::rethrow_exception(problem);
    }

    [[noreturn]] [[gnu::cold, gnu::noinline]] static void throw_in_use() {
        throw std::logic_error(
            "thread_pool: expected one call at a time, found one within another, or of two "
            "threads: give each caller a pool of its own");
    }

    // Layers follow each other within microseconds: a short spin avoids the scheduler.
    static constexpr std::size_t patience = 4096, yields = 8;

    void wait_until_busy_are(std::size_t threads) const {
        for (std::size_t spin = 0; busy_.load(std::memory_order_acquire) != threads; ++spin)
            if (spin > patience)
                std::this_thread::yield();
    }
    // Not round_.notify_all() and round_.wait(): without futexes, as on Windows, those of libstdc++ 12 lose
    // the call of a thread that is about to sleep. Here it either sees the round or is seen to sleep, since
    // both are sequentially consistent.
    void announce() {
        ++round_;
        if (sleeping_ > 0) {
            const std::lock_guard until_it_sleeps(falling_asleep_);
            announced_.notify_all();
        }
    }
    void wait_for_round_after(std::uint32_t seen) {
        for (std::size_t spin = 0; spin < patience + yields; ++spin) {
            if (round_.load(std::memory_order_acquire) != seen)
                return;
            if (spin > patience)
                std::this_thread::yield();
        }
        ++sleeping_;
        std::unique_lock lock(falling_asleep_);
        announced_.wait(lock, [&] { return round_ != seen; });
        --sleeping_;
    }
    void note_problem(std::size_t index) noexcept {
        problems_[index] = std::current_exception();
        failed_.store(true, std::memory_order_relaxed);
    }
    std::exception_ptr first_problem() {
        failed_.store(false, std::memory_order_relaxed);
        std::exception_ptr first;
        for (std::exception_ptr& problem : problems_)
            if (std::exception_ptr found = std::exchange(problem, nullptr); !first)
                first = std::move(found);
        return first;
    }
    void work(std::size_t index) noexcept {
        std::uint32_t seen = 0;
        while (true) {
            wait_for_round_after(seen);
            ++seen; // by one: a round is announced only after the last one has ended
            if (!call_)
                return;
            try {
                call_(body_, share{index, threads_});
            } catch (...) {
                note_problem(index);
            }
            busy_.fetch_sub(1, std::memory_order_release);
        }
    }

    std::size_t threads_;
    std::mutex falling_asleep_;
    std::condition_variable announced_;
    std::atomic<std::uint32_t> round_{0};
    std::atomic<std::size_t> sleeping_{0}; // workers that wait for `announced_`, or are about to
    std::atomic<std::size_t> busy_{0};     // threads that are in a call, the caller among them
    std::atomic<bool> failed_{false};
    void (*call_)(const void*, share) = nullptr;
    const void* body_ = nullptr;
    std::vector<std::exception_ptr> problems_; // by share
    std::vector<std::thread> workers_;
};

}} // namespace tactnet
