// Deployed inference and its peers: runs the benchmarks (see --help; --benchmark_out=FILE for JSON), then
// prints a table of medians, spreads, ratios to each peer and shares of the core's multiply-add peak,
// measured in the same run. Rounds of all benchmarks are interleaved, so that a change of the machine's speed
// meets them alike. --table=FILE and --table_8bit=FILE write CSV; with --fastest the tables have the fastest
// round in place of the median, for a machine that others use too.

#include "inference.hpp"

#include "../support/peak.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace {

/// Keeps the time of every round.
class collector final : public benchmark::ConsoleReporter {
public:
    explicit collector(bool fastest) : ConsoleReporter(OO_None), fastest_(fastest) {}
    void ReportRuns(const std::vector<Run>& runs) override {
        for (const Run& run : runs)
            if (run.error_occurred)
                failed_ = true;
            else if (run.run_type == Run::RT_Iteration)
                seconds_[run.run_name.function_name].push_back(run.real_accumulated_time /
                                                               static_cast<double>(run.iterations));
        ConsoleReporter::ReportRuns(runs);
    }
    [[nodiscard]] bool failed() const { return failed_; }
    /// Median, or the fastest, and half the distance of the quartiles, as a share of it; no number where it
    /// did not run.
    struct summary {
        double median, spread;
    };
    [[nodiscard]] summary of(const std::string& name) const {
        const auto found = seconds_.find(name);
        if (found == seconds_.end())
            return {std::nan(""), std::nan("")};
        std::vector<double> s = found->second;
        std::sort(s.begin(), s.end());
        const double median = fastest_ ? s.front() : s[s.size() / 2];
        return {median, (s[s.size() * 3 / 4] - s[s.size() / 4]) / 2 / median};
    }

private:
    std::map<std::string, std::vector<double>> seconds_;
    bool fastest_, failed_ = false;
};

void print_table(const collector& all, std::size_t batch, double peak, std::FILE* csv) {
    std::printf("\nbatch %zu, microseconds a frame (median, half the quartiles' distance)\n"
                "%-20s %18s %18s %8s %9s\n",
                batch, "network", "tactnet", "onednn", "ratio", "of peak");
    double logarithms = 0, smallest = 1e9;
    std::size_t count = 0;
    for (const auto& c : benchmark::inference_cases()) {
        const std::string end = c.name + "/batch" + std::to_string(batch);
        const auto ours = all.of("tactnet/" + end), theirs = all.of("onednn/" + end);
        const double ratio = theirs.median / ours.median, frames = static_cast<double>(batch);
        std::printf("%-20s %9.2f ± %4.1f %% %9.2f ± %4.1f %% %8.2f %7.1f %%\n", c.name.c_str(),
                    1e6 * ours.median / frames, 100 * ours.spread, 1e6 * theirs.median / frames,
                    100 * theirs.spread, ratio,
                    100 * frames * static_cast<double>(c.multiply_adds_on_pixels) / ours.median / peak);
        if (csv)
            std::fprintf(csv, "%s,%zu,%zu,%.4g,%.3g,%.4g,%.3g,%.4g,%.4g\n", c.name.c_str(), batch,
                         c.multiply_adds_on_pixels, 1e6 * ours.median / frames, ours.spread,
                         1e6 * theirs.median / frames, theirs.spread, ratio,
                         frames * static_cast<double>(c.multiply_adds_on_pixels) / ours.median / peak);
        if (std::isfinite(ratio)) {
            logarithms += std::log(ratio);
            smallest = std::min(smallest, ratio);
            ++count;
        }
    }
    if (count > 0)
        std::printf("geometric mean of %zu ratios %.2f, smallest %.2f\n", count,
                    std::exp(logarithms / static_cast<double>(count)), smallest);
}

/// In 8 bits, beside oneDNN's own and beside single precision.
void print_8bit_table(const collector& all, std::size_t batch, std::FILE* csv) {
    std::printf("\nin 8 bits, batch %zu, microseconds a frame (median, half the quartiles' distance)\n"
                "%-20s %18s %18s %8s %12s\n",
                batch, "network", "tactnet_8bit", "onednn_8bit", "ratio", "÷ tactnet");
    double logarithms = 0, of_floats = 0, smallest = 1e9;
    std::size_t count = 0;
    for (const auto& c : benchmark::inference_cases()) {
        const std::string end = c.name + "/batch" + std::to_string(batch);
        const auto ours = all.of("tactnet_8bit/" + end), theirs = all.of("onednn_8bit/" + end),
                   floats = all.of("tactnet/" + end);
        const double ratio = theirs.median / ours.median, frames = static_cast<double>(batch),
                     to_floats = floats.median / ours.median;
        std::printf("%-20s %9.2f ± %4.1f %% %9.2f ± %4.1f %% %8.2f %11.2f\n", c.name.c_str(),
                    1e6 * ours.median / frames, 100 * ours.spread, 1e6 * theirs.median / frames,
                    100 * theirs.spread, ratio, to_floats);
        if (csv)
            std::fprintf(csv, "%s,%zu,%.4g,%.3g,%.4g,%.3g,%.4g,%.4g\n", c.name.c_str(), batch,
                         1e6 * ours.median / frames, ours.spread, 1e6 * theirs.median / frames, theirs.spread,
                         ratio, to_floats);
        if (std::isfinite(ratio) && std::isfinite(to_floats)) {
            logarithms += std::log(ratio), of_floats += std::log(to_floats);
            smallest = std::min(smallest, ratio);
            ++count;
        }
    }
    if (count > 0)
        std::printf(
            "geometric means of %zu: %.2f times as fast as oneDNN in 8 bits (smallest %.2f), %.2f times as "
            "fast as single precision\n",
            count, std::exp(logarithms / static_cast<double>(count)), smallest,
            std::exp(of_floats / static_cast<double>(count)));
}

} // namespace

int main(int argc, char** argv) {
    benchmark::RegisterBenchmark("peak/multiply_adds", [](benchmark::State& state) {
        float check = 1;
        for (auto _ : state)
            check = std::isfinite(benchmark::run_chains(check)) ? 1.0f : 0.0f;
        if (check != 1.0f)
            state.SkipWithError("not a number");
    });
    std::vector<std::string> options{argv[0], "--benchmark_repetitions=7", "--benchmark_min_time=0.05",
                                     "--benchmark_enable_random_interleaving=true",
                                     "--benchmark_report_aggregates_only=false"};
    std::FILE *csv = nullptr, *csv_8bit = nullptr;
    bool fastest = false;
    for (const std::string& option : std::vector<std::string>(argv + 1, argv + argc)) {
        const bool whole = option.starts_with("--table="), bytes = option.starts_with("--table_8bit=");
        fastest = fastest || option == "--fastest";
        if (whole || bytes) {
            const std::string file = option.substr(option.find('=') + 1);
            std::FILE* const opened = std::fopen(file.c_str(), "w");
            if (!opened)
                return std::perror(file.c_str()), EXIT_FAILURE;
            (whole ? csv : csv_8bit) = opened;
        } else if (option != "--fastest") {
            options.push_back(option);
        }
    }
    std::vector<char*> pointers;
    for (std::string& o : options)
        pointers.push_back(o.data());
    int count = static_cast<int>(pointers.size());
    benchmark::Initialize(&count, pointers.data());
    if (benchmark::ReportUnrecognizedArguments(count, pointers.data()))
        return EXIT_FAILURE;
    std::sort(
        benchmark::inference_cases().begin(), benchmark::inference_cases().end(),
        [](const auto& a, const auto& b) { return a.multiply_adds_on_pixels < b.multiply_adds_on_pixels; });
    collector all(fastest);
    benchmark::RunSpecifiedBenchmarks(&all);
    const double peak =
        static_cast<double>(benchmark::multiply_adds_of_chains) / all.of("peak/multiply_adds").median;
    std::printf("\none core, %zu lanes, multiply-add peak %.1f GFLOP/s\n", tactnet::kernels::lanes<float>,
                2e-9 * peak);
    if (csv)
        std::fprintf(
            csv, "network,batch,multiply_adds_on_pixels,tactnet_us,tactnet_spread,onednn_us,onednn_spread,"
                 "ratio,share_of_peak\n");
    for (const std::size_t batch : {std::size_t{1}, std::size_t{64}})
        print_table(all, batch, peak, csv);
    if (csv_8bit)
        std::fprintf(csv_8bit, "network,batch,tactnet_8bit_us,tactnet_8bit_spread,onednn_8bit_us,"
                               "onednn_8bit_spread,ratio,ratio_to_single_precision\n");
    for (const std::size_t batch : {std::size_t{1}, std::size_t{64}})
        print_8bit_table(all, batch, csv_8bit);
    for (std::FILE* const file : {csv, csv_8bit})
        if (file && std::fclose(file) != 0)
            return std::perror("--table"), EXIT_FAILURE;
    return all.failed() ? EXIT_FAILURE : EXIT_SUCCESS;
}
