// Frames a second of batches on all cores ÷ on one, turn by turn. Beside it a loop in registers on all cores
// ÷ on one, which is what the machine gives at most. Run it on an idle machine, not pinned:
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
#include <memory>
#include <span>
#include <thread>
#include <vector>

namespace {

constexpr std::size_t turns = 41, batch = 1024;

/// The median of seconds on one thread ÷ on all, of turns that follow each other.
template <class Body>
double gain(tactnet::thread_pool& one, tactnet::thread_pool& all, const Body& body) {
    const auto seconds = [&](tactnet::thread_pool& pool) {
        const auto start = std::chrono::steady_clock::now();
        body(pool);
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    std::vector<double> gains;
    body(one), body(all);
    for (std::size_t turn = 0; turn < turns; ++turn) {
        const double alone = seconds(one);
        gains.push_back(alone / seconds(all));
    }
    std::nth_element(gains.begin(), gains.begin() + turns / 2, gains.end());
    return gains[turns / 2];
}

/// False if any bit depends on the number of threads.
template <class Network>
bool time_network(const char* name, tactnet::thread_pool& one, tactnet::thread_pool& all) {
    const auto network = std::make_unique<Network>();
    tactnet::initialise(*network, tactnet::he_normal{}, 1);
    const auto deployed = tactnet::deploy(*network);
    std::vector<std::uint8_t> frames(batch * Network::input_shape.size());
    for (std::size_t i = 0; i < frames.size(); ++i)
        frames[i] = static_cast<std::uint8_t>(i * 7 % 251);
    std::vector<float> on_one(batch * Network::outputs), on_all(on_one);
    bool recognised = true;
    const double gained = gain(one, all, [&](tactnet::thread_pool& pool) {
        recognised &=
            deployed(pool, std::span<const std::uint8_t>(frames),
                     std::span<float>(&pool == &one ? on_one : on_all)) == tactnet::frame_status::recognised;
    });
    const bool same = recognised && on_one == on_all;
    std::printf("%-20s %8.2f%s\n", name, gained, same ? "" : "  WRONG: other outputs than on one thread");
    return same;
}

} // namespace

int main(int count, char** arguments) {
    const std::size_t threads =
        count > 1 ? std::strtoul(arguments[1], nullptr, 10) : std::thread::hardware_concurrency();
    tactnet::thread_pool one(1), all(std::max<std::size_t>(threads, 1));
    std::printf("%s\n%zu threads, batches of %zu frames; frames a second ÷ those on one thread\n",
                processor_name().c_str(), all.threads(), batch);
    std::atomic<float> kept = 0;
    const double ceiling = gain(one, all, [&](tactnet::thread_pool& pool) {
        pool.for_each(64 * all.threads(), [&](std::size_t i) {
            kept = benchmark::run_chains(1 + 1e-6f * static_cast<float>(i));
        });
    });
    std::printf("%-20s %8.2f\n", "loop in registers", ceiling);
    using tactnet::shape;
    bool right = true;
    right &= time_network<tactnet::tactnet4<shape{7, 13}, 22>>("tactnet4/7x13", one, all);
    right &= time_network<tactnet::tactnet4<shape{28, 50}, 22>>("tactnet4/28x50", one, all);
    right &= time_network<tactnet::tactnet6<shape{28, 50}, 22>>("tactnet6/28x50", one, all);
    right &= time_network<tactnet::tactnet6<shape{7, 13}, 22>>("tactnet6/7x13", one, all);
    right &= time_network<tactnet::tactnet6<shape{10, 18}, 22>>("tactnet6/10x18", one, all);
    right &= time_network<tactnet::tactresnet<shape{28, 50}, 22>>("tactresnet/28x50", one, all);
    return right ? EXIT_SUCCESS : EXIT_FAILURE;
}
