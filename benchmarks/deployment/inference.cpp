// Deployed inference and its peers: runs the benchmarks (see --help; --benchmark_out=FILE for JSON), then
// prints a table of medians, spreads, ratios to each peer and shares of the core's multiply-add peak,
// measured in the same run. Rounds of all benchmarks are interleaved, so that a change of the machine's speed
// meets them alike; there are more of them until each ratio is known to 3 % (--known_to=0.03), or a time has
// passed (--seconds=300; with 0 there are seven rounds). A loop in registers runs in turns with them and
// shows how much of that is the machine's. --table=FILE and --table_8bit=FILE write CSV; with --fastest the
// tables have the fastest round in place of the median, for a machine that others use too.

#include "inference.hpp"

#include "../../examples/support/processor.hpp"
#include "../support/peak.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <utility>

namespace {

/// Keeps the time of every round.
class collector final : public benchmark::ConsoleReporter {
public:
    bool ReportContext(const Context& context) override { // once, not for each call
        const bool told = std::exchange(told_, true);
        return told || ConsoleReporter::ReportContext(context);
    }
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
    /// Median, or the fastest; half the distance of the quartiles and the median's standard error, as shares
    /// of it. No numbers where it did not run.
    struct summary {
        double median, spread, error;
    };
    [[nodiscard]] summary of(const std::string& name) const {
        const auto found = seconds_.find(name);
        if (found == seconds_.end())
            return {std::nan(""), std::nan(""), std::nan("")};
        std::vector<double> s = found->second;
        std::sort(s.begin(), s.end());
        const double median = fastest_ ? s.front() : s[s.size() / 2];
        const double spread = (s[s.size() * 3 / 4] - s[s.size() / 4]) / 2 / median;
        // For a normal distribution, half the quartiles' distance is 0.6745 σ and the median's error 1.2533 σ
        // ÷ √n.
        return {median, spread, 1.2533 / 0.6745 * spread / std::sqrt(static_cast<double>(s.size()))};
    }

private:
    std::map<std::string, std::vector<double>> seconds_;
    bool fastest_, failed_ = false, told_ = false;
};

/// The standard error of a ratio of two medians, as a share of it.
double error_of_ratio(const collector::summary& a, const collector::summary& b) {
    return std::hypot(a.error, b.error);
}

/// Peers other than oneDNN that were found when this was compiled.
constexpr const char* other_peers[] = {"onnxruntime", "opencv_dnn", "libtorch", "ncnn"};

/// The fastest peer of a case ("tactnet6/28x50/batch1"); in 8 bits there is oneDNN alone.
collector::summary fastest_peer(const collector& all, const std::string& end) {
    auto best = all.of("onednn/" + end);
    for (const char* const name : other_peers)
        if (const auto other = all.of(name + ("/" + end));
            other.median < best.median || std::isnan(best.median))
            best = other;
    return best;
}

/// The largest of all ratios that were measured; infinite where there are none.
double largest_error(const collector& all) {
    double largest = -1;
    for (const auto& c : benchmark::inference_cases())
        for (const char* const batch : {"/batch1", "/batch64"}) {
            const std::string end = c.name + batch;
            for (const double error :
                 {error_of_ratio(all.of("tactnet/" + end), fastest_peer(all, end)),
                  error_of_ratio(all.of("tactnet_8bit/" + end), all.of("onednn_8bit/" + end))})
                largest = std::isfinite(error) ? std::max(largest, error) : largest;
        }
    return largest < 0 ? std::numeric_limits<double>::infinity() : largest;
}

void print_table(const collector& all, std::size_t batch, double peak, std::FILE* csv) {
    std::printf(
        "\nbatch %zu, microseconds a frame (median, half the quartiles' distance); ratio: of oneDNN, or of "
        "a peer that is faster\n"
        "%-16s %18s %18s %15s %8s",
        batch, "network", "tactnet", "onednn", "ratio", "of peak");
    for (const char* const name : other_peers)
        std::printf(" %11s", name);
    std::printf("\n");
    double logarithms = 0, smallest = 1e9;
    std::size_t count = 0;
    for (const auto& c : benchmark::inference_cases()) {
        const std::string end = c.name + "/batch" + std::to_string(batch);
        const auto ours = all.of("tactnet/" + end), theirs = all.of("onednn/" + end);
        const auto best = fastest_peer(all, end);
        const double frames = static_cast<double>(batch);
        const double ratio = best.median / ours.median, error = error_of_ratio(ours, best);
        const double share = frames * static_cast<double>(c.multiply_adds_on_pixels) / ours.median / peak;
        std::printf("%-16s %9.2f ± %4.1f %% %9.2f ± %4.1f %% %6.2f ± %4.1f %% %6.1f %%", c.name.c_str(),
                    1e6 * ours.median / frames, 100 * ours.spread, 1e6 * theirs.median / frames,
                    100 * theirs.spread, ratio, 100 * error, 100 * share);
        if (csv)
            std::fprintf(csv, "%s,%zu,%zu,%.4g,%.3g,%.4g,%.3g,%.4g,%.4g,%.2g", c.name.c_str(), batch,
                         c.multiply_adds_on_pixels, 1e6 * ours.median / frames, ours.spread,
                         1e6 * theirs.median / frames, theirs.spread, ratio, share, error);
        for (const char* const name : other_peers) {
            const double microseconds = 1e6 * all.of(name + ("/" + end)).median / frames;
            std::printf(" %11.2f", microseconds);
            if (csv)
                std::fprintf(csv, ",%.4g", microseconds);
        }
        std::printf("\n");
        if (csv)
            std::fprintf(csv, ",%s\n", processor_name().c_str());
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

/// In 8 bits, compared with oneDNN's int8 and with single precision.
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
            std::fprintf(csv, "%s,%zu,%.4g,%.3g,%.4g,%.3g,%.4g,%.4g,%s\n", c.name.c_str(), batch,
                         1e6 * ours.median / frames, ours.spread, 1e6 * theirs.median / frames, theirs.spread,
                         ratio, to_floats, processor_name().c_str());
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
    double known_to = 0.03, seconds = 300;
    for (const std::string& option : std::vector<std::string>(argv + 1, argv + argc)) {
        const bool whole = option.starts_with("--table="), bytes = option.starts_with("--table_8bit=");
        fastest = fastest || option == "--fastest";
        if (whole || bytes) {
            const std::string file = option.substr(option.find('=') + 1);
            std::FILE* const opened = std::fopen(file.c_str(), "w");
            if (!opened)
                return std::perror(file.c_str()), EXIT_FAILURE;
            (whole ? csv : csv_8bit) = opened;
        } else if (option.starts_with("--known_to=") || option.starts_with("--seconds=")) {
            const std::string text = option.substr(option.find('=') + 1);
            char* end = nullptr;
            const double value = std::strtod(text.c_str(), &end);
            if (text.empty() || *end != '\0' || !(value >= 0))
                return std::fprintf(stderr, "expected a number from 0 on, found %s\n", option.c_str()),
                       EXIT_FAILURE;
            (option[2] == 'k' ? known_to : seconds) = value;
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
    const auto begin = std::chrono::steady_clock::now();
    const auto passed = [&] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    double last = 0; // how long a call takes: none is begun that would end too late
    do {
        const double before = passed();
        benchmark::RunSpecifiedBenchmarks(&all);
        last = passed() - before;
    } while (!all.failed() && std::isfinite(largest_error(all)) && largest_error(all) > known_to &&
             passed() + last < seconds);
    const auto registers = all.of("peak/multiply_adds");
    const double peak = static_cast<double>(benchmark::multiply_adds_of_chains) / registers.median;
    std::printf("\none core, %zu lanes, multiply-add peak %.1f GFLOP/s\n", tactnet::kernels::lanes<float>,
                2e-9 * peak);
    if (std::isfinite(largest_error(all)))
        std::printf("the ratio that is known worst is known to ± %.1f %%%s; ", 100 * largest_error(all),
                    fastest ? ", of medians"
                    : largest_error(all) > known_to
                        ? ": this machine is too noisy for more, or needs more --seconds"
                        : "");
    std::printf("a loop in registers varied by ± %.1f %%\n", 100 * registers.spread);
    if (csv) {
        std::fprintf(csv, "network,batch,multiply_adds_on_pixels,tactnet_us,tactnet_spread,onednn_us,"
                          "onednn_spread,ratio,share_of_peak,ratio_error");
        for (const char* const name : other_peers)
            std::fprintf(csv, ",%s_us", name);
        std::fprintf(csv, ",processor\n");
    }
    for (const std::size_t batch : {std::size_t{1}, std::size_t{64}})
        print_table(all, batch, peak, csv);
    if (csv_8bit)
        std::fprintf(csv_8bit, "network,batch,tactnet_8bit_us,tactnet_8bit_spread,onednn_8bit_us,"
                               "onednn_8bit_spread,ratio,ratio_to_single_precision,processor\n");
    for (const std::size_t batch : {std::size_t{1}, std::size_t{64}})
        print_8bit_table(all, batch, csv_8bit);
    for (std::FILE* const file : {csv, csv_8bit})
        if (file && std::fclose(file) != 0)
            return std::perror("--table"), EXIT_FAILURE;
    return all.failed() ? EXIT_FAILURE : EXIT_SUCCESS;
}
