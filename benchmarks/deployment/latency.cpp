// How even the latency of a deployed network is: every one of 100 000 calls on TactNet-6 at 28 × 50 is timed
// by itself. Beside it, in turns, a loop of as many multiply-adds in registers, which shows what the machine
// itself does to a program of that length. Run it pinned to an idle core.

#include "../support/peak.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/networks.hpp>
#include <tactnet/training/initialise.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

namespace {

using network = tactnet::tactnet6<tactnet::shape{28, 50, 1}, 22>;
constexpr std::size_t calls = 100'000, warm_up = 1'000;

/// Microseconds of one call.
template <class Body>
double time(Body&& body) {
    const auto start = std::chrono::steady_clock::now();
    body();
    return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

void print(const char* name, std::vector<double> microseconds) {
    std::sort(microseconds.begin(), microseconds.end());
    const auto quantile = [&](double share) {
        return microseconds[static_cast<std::size_t>(share * static_cast<double>(microseconds.size() - 1))];
    };
    std::printf("%-18s %8.2f %8.2f %8.2f %8.2f %8.2f %14.3f\n", name, quantile(0.5), quantile(0.99),
                quantile(0.999), quantile(0.9999), microseconds.back(), quantile(0.999) / quantile(0.5));
}

} // namespace

int main() {
    network trained;
    tactnet::initialise(trained, tactnet::he_normal{}, 1);
    const auto deployed = tactnet::deploy(trained);
    tactnet::tensor<std::uint8_t, network::input_shape> frame;
    for (std::size_t e = 0; e < frame.size(); ++e)
        frame.data()[e] = static_cast<std::uint8_t>(e * 7 % 256);
    const tactnet::tensor_view<const std::uint8_t, network::input_shape> counts(frame);
    decltype(deployed)::workspace memory;
    std::array<float, network::outputs> logits{}, first{};
    if (deployed.infer(counts, first, memory) != tactnet::frame_status::ok)
        return EXIT_FAILURE;

    std::vector<double> ours, machine;
    ours.reserve(calls), machine.reserve(calls);
    float check = 1;
    bool same = true;
    for (std::size_t call = 0; call < calls + warm_up; ++call) {
        auto status = tactnet::frame_status::not_finite;
        const double of_network = time([&] { status = deployed.infer(counts, logits, memory); });
        const double of_loop =
            time([&] { check = std::isfinite(benchmark::run_chains(check)) ? 1.0f : 0.0f; });
        same = same && logits == first && status == tactnet::frame_status::ok;
        if (call >= warm_up)
            ours.push_back(of_network), machine.push_back(of_loop);
    }
    std::printf("%zu calls in turns, microseconds\n%-18s %8s %8s %8s %8s %8s %14s\n", calls, "", "median",
                "99 %", "99.9 %", "99.99 %", "most", "99.9 % ÷ median");
    print("TactNet-6 28x50", std::move(ours));
    print("registers only", std::move(machine));
    if (!same || check != 1.0f)
        std::printf("DIFFERENT results from call to call\n");
    return same && check == 1.0f ? EXIT_SUCCESS : EXIT_FAILURE;
}
