// Checks within a minute whether the methods chosen for networks deployed in single precision suit this
// processor: prints for each layer its method, its time among the others, its share of the core's peak, the
// source of its weights, the time of the fastest other method, and the costs by which the method was chosen
// (in twentieths of a multiply-add of a vector).
//
//     benchmark_plan [--networks=tactnet6/28x50,tactresnet/28x50] [--csv=FILE]
//
// Pin it to one core that is idle. Exit status 1 if the steps one by one do not give the bits of a call.

#include "plan.hpp"

#include "../support/options.hpp"
#include "../support/peak.hpp"

#include <tactnet/detail/instruction_set.hpp>

#include <cstdio>
#include <cstdlib>
#include <string_view>

#if defined(__unix__)
#include <unistd.h>
#endif

namespace {

/// Bytes of the caches of this core, 0 if the system does not report them.
struct cache_sizes {
    double first = 0, second = 0, third = 0;

    static cache_sizes of_this_machine() {
#if defined(_SC_LEVEL1_DCACHE_SIZE)
        const auto bytes = [](int level) { return std::max(static_cast<double>(sysconf(level)), 0.0); };
        return {bytes(_SC_LEVEL1_DCACHE_SIZE), bytes(_SC_LEVEL2_CACHE_SIZE), bytes(_SC_LEVEL3_CACHE_SIZE)};
#else
        return {};
#endif
    }
    /// What holds so many bytes from one frame to the next.
    [[nodiscard]] const char* holding(std::size_t bytes) const {
        const auto size = static_cast<double>(bytes);
        return first <= 0       ? ""
               : size <= first  ? "L1"
               : size <= second ? "L2"
               : size <= third  ? "L3"
                                : "memory";
    }
};

/// Another method counts as faster if it takes less than this share of the time: smaller differences come and
/// go with the clock of the machine.
constexpr double clearly_faster = 0.95;

void print(const benchmark::network_report& report, const cache_sizes& caches, double peak, std::FILE* csv) {
    const char* const from = caches.holding(report.bytes);
    std::printf("\n%s: %.2f µs a frame, %.0f kB of weights and maps (%s)%s\n", report.name.c_str(),
                1e6 * report.whole, static_cast<double>(report.bytes) / 1000, from,
                report.right ? "" : ", WRONG BITS");
    std::printf("  %-44s %-14s %-16s %8s %6s %8s %6s %9s  %s\n", "layer", "output", "plan", "µs", "peak",
                "weights", "GB/s", "alone, µs", "other plan, µs");
    double sum = 0;
    for (const benchmark::layer_report& layer : report.layers) {
        sum += layer.in_network;
        const double share = static_cast<double>(layer.multiply_adds) / layer.in_network / peak;
        char other[64] = "";
        if (!layer.other_plan.empty())
            std::snprintf(other, sizeof(other), "%s %.2f%s", layer.other_plan.c_str(), 1e6 * layer.by_other,
                          layer.by_other < clearly_faster * layer.alone ? "  FASTER" : "");
        char alone[16] = "", of_peak[16] = "";
        if (layer.alone > 0)
            std::snprintf(alone, sizeof(alone), "%.2f", 1e6 * layer.alone);
        if (layer.multiply_adds > 0)
            std::snprintf(of_peak, sizeof(of_peak), "%.0f %%", 100 * share);
        std::printf("  %-44s %-14s %-16s %8.2f %6s %5.0f kB %6.1f %9s  %s\n", layer.what.c_str(),
                    layer.output.c_str(), layer.plan.c_str(), 1e6 * layer.in_network, of_peak,
                    static_cast<double>(layer.weight_bytes) / 1000,
                    1e-9 * static_cast<double>(layer.weight_bytes) / layer.in_network, alone, other);
        if (!layer.costs.empty())
            std::printf("    costs: %s\n", layer.costs.c_str());
        if (csv)
            std::fprintf(csv, "%s,\"%s\",%s,\"%s\",%zu,%zu,%zu,%.4g,%.4g,%.4g,\"%s\",%.4g,\"%s\"\n",
                         report.name.c_str(), layer.what.c_str(), layer.output.c_str(), layer.plan.c_str(),
                         layer.multiply_adds, layer.weight_bytes, layer.map_bytes, 1e6 * layer.in_network,
                         share, 1e6 * layer.alone, layer.other_plan.c_str(), 1e6 * layer.by_other,
                         layer.costs.c_str());
    }
    std::printf("  %-76s %8.2f\n", "all layers, the clock between them", 1e6 * sum);
}

} // namespace

int main(int argc, char** argv) {
    std::string networks;
    std::FILE* csv = nullptr;
    for (const std::string_view option : std::vector<std::string_view>(argv + 1, argv + argc)) {
        if (option.starts_with("--networks=")) {
            networks = option.substr(11);
        } else if (option.starts_with("--csv=")) {
            const std::string file(option.substr(6));
            csv = std::fopen(file.c_str(), "w");
            if (!csv)
                return std::perror(file.c_str()), EXIT_FAILURE;
            std::fprintf(csv, "network,layer,output,plan,multiply_adds_on_pixels,weight_bytes,map_bytes,us,"
                              "share_of_peak,alone_us,other_plan,other_plan_us,costs\n");
        } else {
            std::fprintf(stderr, "benchmark_plan: expected --networks=NAME,... or --csv=FILE, found '%.*s'\n",
                         static_cast<int>(option.size()), option.data());
            return EXIT_FAILURE;
        }
    }
    auto& cases = benchmark::plan_cases();
    std::sort(cases.begin(), cases.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    std::vector<const benchmark::plan_case*> wanted;
    for (const benchmark::plan_case& one : cases)
        if (benchmark::listed(networks, one.name))
            wanted.push_back(&one);
    if (wanted.empty()) {
        std::fprintf(stderr, "benchmark_plan: expected some of");
        for (const benchmark::plan_case& one : cases)
            std::fprintf(stderr, " %s", one.name.c_str());
        std::fprintf(stderr, ", found '%s'\n", networks.c_str());
        return EXIT_FAILURE;
    }

    const cache_sizes caches = cache_sizes::of_this_machine();
    float check = 1;
    const double seconds_of_chains =
        benchmark::seconds_of([&] { check = std::isfinite(benchmark::run_chains(check)) ? 1.0f : 0.0f; });
    const double peak = static_cast<double>(benchmark::multiply_adds_of_chains) / seconds_of_chains;
    std::printf("%s, one core, %zu lanes, multiply-add peak %.1f GFLOP/s, caches %.0f kB, %.0f kB, %.0f kB\n"
                "µs: fastest of many frames; peak: by taps on real pixels; GB/s: weights through the layer\n",
                tactnet::instruction_set.data(), tactnet::kernels::lanes<float>, 2e-9 * peak,
                caches.first / 1000, caches.second / 1000, caches.third / 1000);
    bool right = check == 1.0f;
    std::size_t slower = 0;
    for (const benchmark::plan_case* one : wanted) {
        const benchmark::network_report report = one->measure();
        print(report, caches, peak, csv);
        right = right && report.right;
        for (const benchmark::layer_report& layer : report.layers)
            slower += !layer.other_plan.empty() && layer.by_other < clearly_faster * layer.alone;
    }
    std::printf("\n%zu %s of another plan would be faster here by more than %.0f %%\n", slower,
                slower == 1 ? "layer" : "layers", 100 * (1 - clearly_faster));
    if (csv && std::fclose(csv) != 0)
        return std::perror("--csv"), EXIT_FAILURE;
    return right ? EXIT_SUCCESS : EXIT_FAILURE;
}
