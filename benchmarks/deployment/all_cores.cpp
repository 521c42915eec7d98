// Frames a second of batches on all cores ÷ on one. Beside it a loop in registers on all cores ÷ on one,
// which is what the machine gives at most. Batches follow each other, as from a recording, for 20
// milliseconds and more a turn, so that what a core takes to wake up is no part of it; turns of all cases are
// interleaved, so that what else the machine does meets them alike. Run it on an idle machine, not pinned:
//   benchmark_all_cores [THREADS]

#include "../../examples/support/processor.hpp"
#include "../support/peak.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/networks.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/training/initialise.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace {

constexpr std::size_t turns = 61, batch = 1024;
constexpr double least_seconds = 20e-3;

/// What is timed on one thread and on all.
struct scaling_case {
    std::string name;
    std::function<void(tactnet::thread_pool&)> body;
    std::function<bool()> right = [] { return true; }; ///< whether no bit depended on the number of threads
    std::size_t repeats = 1;                           ///< of the body in a turn
    std::vector<double> gains{};                       ///< seconds on one thread ÷ on all, turn by turn

    double seconds(tactnet::thread_pool& pool) const {
        const auto start = std::chrono::steady_clock::now();
        for (std::size_t i = 0; i < repeats; ++i)
            body(pool);
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    [[nodiscard]] double quantile(double share) {
        std::sort(gains.begin(), gains.end());
        return gains[static_cast<std::size_t>(share * static_cast<double>(gains.size() - 1))];
    }
};

template <class Network>
scaling_case case_of(const char* name) {
    struct state {
        tactnet::deployed<Network> deployed;
        std::vector<std::uint8_t> frames = std::vector<std::uint8_t>(batch * Network::input_shape.size());
        std::vector<float> on_one = std::vector<float>(batch * Network::outputs), on_all = on_one;
        bool ok = true;
    };
    const auto network = std::make_unique<Network>();
    tactnet::initialise(*network, tactnet::he_normal{}, 1);
    const auto held = std::make_shared<state>(state{tactnet::deploy(*network)});
    for (std::size_t i = 0; i < held->frames.size(); ++i)
        held->frames[i] = static_cast<std::uint8_t>(i * 7 % 251);
    return {.name = name,
            .body =
                [held](tactnet::thread_pool& pool) {
                    held->ok &=
                        held->deployed.infer(held->frames, pool.threads() == 1 ? held->on_one : held->on_all,
                                             pool) == tactnet::frame_status::ok;
                },
            .right = [held] { return held->ok && held->on_one == held->on_all; }};
}

} // namespace

int main(int count, char** arguments) {
    const std::size_t threads =
        count > 1 ? std::strtoul(arguments[1], nullptr, 10) : std::thread::hardware_concurrency();
    if (threads < 2) {
        std::fprintf(stderr, "benchmark_all_cores: expected at least 2 threads, found %zu\n", threads);
        return EXIT_FAILURE;
    }
    tactnet::thread_pool one(1), all(threads);
    std::atomic<float> kept = 0;
    using tactnet::shape;
    std::vector<scaling_case> cases;
    cases.push_back({.name = "loop in registers", .body = [&](tactnet::thread_pool& pool) {
                         pool.for_each(64 * threads, [&](std::size_t i) {
                             kept = benchmark::run_chains(1 + 1e-6f * static_cast<float>(i));
                         });
                     }});
    cases.push_back(case_of<tactnet::tactnet4<shape{7, 13}, 22>>("tactnet4/7x13"));
    cases.push_back(case_of<tactnet::tactnet4<shape{28, 50}, 22>>("tactnet4/28x50"));
    cases.push_back(case_of<tactnet::tactnet6<shape{28, 50}, 22>>("tactnet6/28x50"));
    cases.push_back(case_of<tactnet::tactnet6<shape{7, 13}, 22>>("tactnet6/7x13"));
    cases.push_back(case_of<tactnet::tactnet6<shape{10, 18}, 22>>("tactnet6/10x18"));
    cases.push_back(case_of<tactnet::tactresnet<shape{28, 50}, 22>>("tactresnet/28x50"));
    for (scaling_case& one_case : cases) {
        one_case.body(one), one_case.body(all);
        while (one_case.seconds(one) < least_seconds)
            one_case.repeats *= 2;
    }
    for (std::size_t turn = 0; turn < turns; ++turn)
        for (scaling_case& one_case : cases) {
            const double alone = one_case.seconds(one);
            one_case.gains.push_back(alone / one_case.seconds(all));
        }

    std::printf("%s\n%zu threads, batches of %zu frames; frames a second ÷ those on one thread, %zu turns\n"
                "%-20s %8s %16s\n",
                processor_name().c_str(), threads, batch, turns, "", "median", "quartiles");
    bool right = true;
    for (scaling_case& one_case : cases) {
        const bool same = one_case.right();
        right &= same;
        std::printf("%-20s %8.2f %8.2f–%.2f%s\n", one_case.name.c_str(), one_case.quantile(0.5),
                    one_case.quantile(0.25), one_case.quantile(0.75),
                    same ? "" : "  WRONG: other outputs than on one thread");
    }
    return right ? EXIT_SUCCESS : EXIT_FAILURE;
}
