// Calls that find their network in no cache, as in a robot that recognises a frame every 10 ms and does other
// work between: each library is called after other memory was written, then again and again. Compared with a
// plain sum over as many bytes as the packed weights, as cold.
//
//     benchmark_cold [--networks=tactnet6/28x50,...] [--csv=FILE] [--megabytes=96] [--rounds=60]
//
// Megabytes are those of the other memory; four times the second level leave weights in the third. Pin it to
// one core that is idle. Exit status 1 if a result is wrong.

#include "cold.hpp"

#include "../../examples/support/processor.hpp"
#include "../support/measure.hpp"
#include "../support/options.hpp"

#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <numeric>
#include <string_view>

namespace {

/// Microseconds of body(), by a clock that is warm itself.
template <class Body>
double time(Body&& body) {
    using clock = std::chrono::steady_clock;
    static_cast<void>(clock::now());
    const auto start = clock::now();
    body();
    return std::chrono::duration<double, std::micro>(clock::now() - start).count();
}

/// The sum of whole cache lines, by as many vectors as hide the latency.
[[gnu::noinline]] float plain_sum(const tactnet::aligned_vector<float>& values) {
    namespace kernels = tactnet::kernels;
    constexpr std::size_t lanes = kernels::lanes<float>, line = tactnet::cache_line / sizeof(float),
                          lines = 4;
    constexpr std::size_t vectors = lines * line / lanes;
    std::array<kernels::vector<float>, vectors> sums;
    kernels::unroll<vectors>([&](auto v) { sums[v] = kernels::vector<float>(0.0f); });
    for (std::size_t i = 0; i + lines * line <= values.size(); i += lines * line)
        kernels::unroll<vectors>(
            [&](auto v) { sums[v] = sums[v] + kernels::load(values.data() + i + v * lanes); });
    alignas(64) std::array<float, lanes> flat;
    float all = 0;
    kernels::unroll<vectors>([&](auto v) {
        kernels::store(flat.data(), sums[v]);
        all = std::accumulate(flat.begin(), flat.end(), all);
    });
    return all;
}

struct summary {
    double median, spread; ///< half the distance of the quartiles, as a share
};
summary of(std::vector<double> samples) {
    std::sort(samples.begin(), samples.end());
    const double median = samples[samples.size() / 2];
    return {median, (samples[samples.size() * 3 / 4] - samples[samples.size() / 4]) / 2 / median};
}

/// The times of one library, in microseconds.
struct times {
    std::vector<double> cold, warm;
};

class run {
public:
    run(std::size_t megabytes, std::size_t rounds, std::FILE* csv)
        : rounds_(rounds), csv_(csv), other_(megabytes * 1'000'000) {
        if (csv_)
            std::fprintf(csv_, "network,format,library,warm_us,warm_spread,cold_us,cold_spread,packed_bytes,"
                               "parameter_bytes,workspace_bytes,sum_us,other_bytes,processor\n");
        std::printf("calls warm, and cold after %zu MB of other memory; medians of %zu and half the "
                    "quartiles' distance\n"
                    "%-16s %-6s %-12s %9s %17s %18s %6s %8s %8s %7s %7s\n",
                    megabytes, rounds, "network", "", "library", "packed kB", "warm, µs", "cold, µs",
                    "÷ warm", "warm ÷", "cold ÷", "GB/s", "sum's");
    }
    /// False if a result differs from call to call.
    bool measure(const benchmark::cold_case& one) {
        std::vector<benchmark::cold_contender> all = one.make();
        std::vector<times> of_library(all.size());
        const tactnet::aligned_vector<float> ones(one.packed / sizeof(float) / 64 * 64 + 64, 1.0f);
        std::vector<double> sums;
        bool right = true;
        for (std::size_t round = 0; round < rounds_; ++round) {
            for (std::size_t i = 0; i < all.size(); ++i) {
                forget();
                of_library[i].cold.push_back(time([&] { all[i].call(); }));
                right = right && all[i].same();
                // Shorter than a time slice of the system, which other programs would share.
                const int warm_calls = std::clamp(static_cast<int>(300 / of_library[i].cold.back()), 1, 10);
                const auto again = [&] {
                    for (int c = 0; c < warm_calls; ++c)
                        all[i].call();
                };
                for (int warm_up = 0; warm_up < 3; ++warm_up)
                    again();
                of_library[i].warm.push_back(time(again) / warm_calls);
                right = right && all[i].same();
            }
            forget();
            float sum = 0;
            sums.push_back(time([&] { sum = plain_sum(ones); }));
            right = right && sum == static_cast<float>(ones.size());
        }
        print(one, all, of_library, of(sums), ones.size() * sizeof(float));
        if (!right)
            std::printf("%s: DIFFERENT results from call to call\n", one.name.c_str());
        return right;
    }
    /// Prints the geometric means of all ratios to oneDNN.
    void print_means() const {
        for (const auto& [what, ratios] : ratios_) {
            double logarithms = 0;
            for (const double ratio : ratios)
                logarithms += std::log(ratio);
            std::printf("%s: geometric mean of %zu %.2f, smallest %.2f\n", what.c_str(), ratios.size(),
                        std::exp(logarithms / static_cast<double>(ratios.size())),
                        *std::min_element(ratios.begin(), ratios.end()));
        }
    }

private:
    /// Writes to every cache line of the other memory.
    void forget() {
        for (std::size_t i = 0; i < other_.size(); i += tactnet::cache_line)
            *static_cast<volatile unsigned char*>(&other_[i]) = static_cast<unsigned char>(other_[i] + 1);
    }
    void print(const benchmark::cold_case& one, const std::vector<benchmark::cold_contender>& all,
               const std::vector<times>& measured, summary sum, std::size_t summed) {
        const summary our_warm = of(measured[0].warm), our_cold = of(measured[0].cold);
        for (std::size_t i = 0; i < all.size(); ++i) {
            const summary warm = of(measured[i].warm), cold = of(measured[i].cold);
            const double warm_ratio = warm.median / our_warm.median,
                         cold_ratio = cold.median / our_cold.median;
            std::printf("%-16s %-6s %-12s", one.name.c_str(), one.format.c_str(), all[i].library.c_str());
            i == 0 ? std::printf(" %9.1f", static_cast<double>(one.packed) / 1000) : std::printf(" %9s", "");
            std::printf(" %8.2f ± %2.0f %% %9.1f ± %2.0f %% %6.1f %8.2f %8.2f", warm.median,
                        100 * warm.spread, cold.median, 100 * cold.spread, cold.median / warm.median,
                        warm_ratio, cold_ratio);
            if (i == 0)
                std::printf(" %7.1f %7.1f", static_cast<double>(one.packed) / cold.median / 1000,
                            static_cast<double>(summed) / sum.median / 1000);
            std::printf("\n");
            if (all[i].library == "onednn") {
                ratios_[one.format + ", warm, oneDNN ÷ tactnet"].push_back(warm_ratio);
                ratios_[one.format + ", cold, oneDNN ÷ tactnet"].push_back(cold_ratio);
            }
            if (!csv_)
                continue;
            std::fprintf(csv_, "%s,%s,%s,%.4g,%.2g,%.4g,%.2g,", one.name.c_str(), one.format.c_str(),
                         all[i].library.c_str(), warm.median, warm.spread, cold.median, cold.spread);
            if (i == 0)
                std::fprintf(csv_, "%zu,%zu,%zu,%.4g", one.packed, one.parameters, one.workspace,
                             sum.median * static_cast<double>(one.packed) / static_cast<double>(summed));
            else
                std::fprintf(csv_, ",,,");
            std::fprintf(csv_, ",%zu,%s\n", other_.size(), processor_name().c_str());
        }
        std::fflush(stdout);
    }

    std::size_t rounds_;
    std::FILE* csv_;
    std::vector<unsigned char> other_;
    std::map<std::string, std::vector<double>> ratios_;
};

int measure_all(int argc, char** argv) {
    std::string networks;
    std::size_t megabytes = 96, rounds = 60;
    std::FILE* csv = nullptr;
    for (const std::string_view option : std::vector<std::string_view>(argv + 1, argv + argc)) {
        const std::string value(option.substr(std::min(option.find('=') + 1, option.size())));
        if (option.starts_with("--networks=")) {
            networks = value;
        } else if (option.starts_with("--csv=")) {
            csv = std::fopen(value.c_str(), "w");
            if (!csv)
                return std::perror(value.c_str()), EXIT_FAILURE;
        } else if (option.starts_with("--megabytes=") || option.starts_with("--rounds=")) {
            const int number = std::atoi(value.c_str());
            if (number < 1)
                throw std::invalid_argument("expected a number from 1 on, found " + std::string(option));
            (option[2] == 'm' ? megabytes : rounds) = static_cast<std::size_t>(number);
        } else {
            throw std::invalid_argument(
                "expected --networks=NAME,..., --csv=FILE, --megabytes=N or --rounds=N, found " +
                std::string(option));
        }
    }
    auto& cases = benchmark::cold_cases();
    std::stable_sort(cases.begin(), cases.end(), [](const auto& a, const auto& b) {
        return std::pair(b.format, a.packed) < std::pair(a.format, b.packed);
    });
    std::erase_if(cases, [&](const auto& one) { return !benchmark::listed(networks, one.name); });
    if (cases.empty())
        throw std::invalid_argument("expected networks as in --networks=tactnet6/28x50, found " + networks);
    run all(megabytes, rounds, csv);
    bool right = true;
    for (const benchmark::cold_case& one : cases)
        right = all.measure(one) && right;
    all.print_means();
    if (csv && std::fclose(csv) != 0)
        return std::perror("--csv"), EXIT_FAILURE;
    return right ? EXIT_SUCCESS : EXIT_FAILURE;
}

} // namespace

int main(int argc, char** argv) {
    try {
        return measure_all(argc, argv);
    } catch (const std::exception& error) {
        return std::fprintf(stderr, "benchmark_cold: %s\n", error.what()), EXIT_FAILURE;
    }
}
