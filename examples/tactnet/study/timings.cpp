#include "study/timings.hpp"

#include "methods/description.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <processor.hpp>
#include <stopwatch.hpp>
#include <unistd.h>

#if defined(__linux__)
#include <sched.h>
#endif

namespace {

/// Microseconds of each of many calls, sorted; of three or four where five take longer than two seconds.
template <class Work>
std::vector<double> times_of(const Work& work, std::size_t most) {
    constexpr double enough = 0.4; // seconds
    constexpr std::size_t fewest = 3, usual = 5;
    const stopwatch begin;
    for (std::size_t i = 0; i < 3 && begin.seconds() < enough; ++i) // caches and branch predictors
        work();
    std::vector<double> times;
    for (double all = 0; times.size() < fewest || (all < 4 * enough && times.size() < usual) ||
                         (all > 0 && all < enough && times.size() < most);) {
        const stopwatch watch;
        work();
        times.push_back(1e6 * watch.seconds());
        all += 1e-6 * times.back();
    }
    std::sort(times.begin(), times.end());
    return times;
}

double quantile(const std::vector<double>& sorted, double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
    return sorted[std::max<std::size_t>(rank, 1) - 1];
}

/// Steps of a generator, each of which waits for the one before; no memory.
void spin(std::uint64_t steps) {
    std::uint64_t x = steps | 1U;
    for (std::uint64_t i = 0; i < steps; ++i)
        x = x * 6364136223846793005U + 1442695040888963407U;
    [[maybe_unused]] volatile std::uint64_t kept = x; // or a compiler would leave the loop out
}

/// A clock that stands still or runs backwards has measured nothing that a file or a table may hold.
double positive(double measured) {
    if (!(measured > 0))
        throw std::runtime_error(fmt::format(
            "timing: expected a clock that goes forward, found {} microseconds of work", measured));
    return measured;
}

double jitter_over(double microseconds, std::size_t most_calls) {
    constexpr std::uint64_t tried = 100'000;
    constexpr double most = 1e9; // steps: about a second
    const double each = positive(median_microseconds([] { spin(tried); }, 1024)) / static_cast<double>(tried);
    const auto steps = static_cast<std::uint64_t>(std::clamp(microseconds / each, 1.0, most));
    const std::vector<double> times = times_of([&] { spin(steps); }, most_calls);
    return positive(quantile(times, 0.99)) / positive(quantile(times, 0.5));
}

std::string machine_name() {
#if defined(_WIN32)
    const char* const name = std::getenv("COMPUTERNAME");
    return name != nullptr ? name : "unknown";
#else
    std::array<char, 256> name{};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
#endif
}

std::string compiler_name() {
#if defined(__clang__)
    return fmt::format("Clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#elif defined(__GNUC__)
    return fmt::format("GCC {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#else
    return "unknown";
#endif
}

/// Which program measures on which machine.
tactnet::file_metadata this_program() {
    tactnet::file_metadata key{
        {"processor", processor_name()}, {"machine", machine_name()}, {"compiler", compiler_name()}};
    key.merge(describe_program());
    return key;
}

/// Which program has measured a timing, and where.
tactnet::file_metadata program_in(const tactnet::file_metadata& settings) {
    tactnet::file_metadata program;
    for (const auto& [key, value] : this_program())
        if (const auto found = settings.find(key); found != settings.end())
            program[key] = found->second;
    return program;
}

tactnet::file_metadata key_of(const method& what, std::size_t bits, tactnet::file_metadata program) {
    program.merge(tactnet::file_metadata{{"method", what.name},
                                         {"rows", fmt::to_string(what.rows)},
                                         {"columns", fmt::to_string(what.columns)}});
    program.merge(what.parts());
    if (bits == 8)
        program["bits"] = "8";
    return program;
}

} // namespace

void stay_on_this_core() {
#if defined(__linux__)
    cpu_set_t one;
    CPU_ZERO(&one);
    if (const int core = sched_getcpu(); core >= 0) {
        CPU_SET(static_cast<std::size_t>(core), &one);
        static_cast<void>(sched_setaffinity(0, sizeof(one), &one)); // where it is refused, it stays free
    }
#endif
}

frame_latency measure_latency(const method& what, std::size_t bits) {
    const frame_work work = what.make_work(bits);
    const std::size_t multiply_adds = std::max<std::size_t>(what.costs(what.capacity).multiply_adds, 1),
                      most = std::clamp<std::size_t>((std::size_t{1} << 35) / multiply_adds, 64, 20'000);
    const std::vector<double> times = times_of([&] { work(1); }, most);
    frame_latency found;
    found.median = positive(quantile(times, 0.5));
    found.p99 = quantile(times, 0.99);
    found.jitter = jitter_over(found.median, most);
    // Fewer frames at once where a whole batch takes more than four seconds.
    const auto together = static_cast<std::size_t>(
        std::clamp(4e6 / found.median, 1.0, static_cast<double>(what.frames_together())));
    found.in_batch =
        positive(median_microseconds([&] { work(together); }, std::max<std::size_t>(most / together, 1))) /
        static_cast<double>(together);
    return found;
}

timing_list::timing_list(const std::filesystem::path& path) : file_(path), shown_(this_program()) {
    read_on();
}

void timing_list::read_on() {
    file_.read_on("a timing of tactnet study", [&](const std::string& text) {
        const auto line = nlohmann::json::parse(text);
        const auto above_0 = [&](const char* name) {
            const double value = line.at(name);
            if (!(value > 0))
                throw std::runtime_error(fmt::format("expected {} above 0, found {}", name, value));
            return value;
        };
        const auto settings = line.at("settings").get<tactnet::file_metadata>();
        latest_ = program_in(settings);
        all_[settings] = {above_0("median"), above_0("p99"), above_0("in_batch"), above_0("jitter")};
    });
}

void timing_list::show_latest() {
    if (!latest_.empty())
        shown_ = latest_;
}

bool timing_list::others() const {
    return shown_ != this_program();
}

const frame_latency* timing_list::find(const method& what, std::size_t bits) const {
    const auto found = all_.find(key_of(what, bits, shown_));
    return found == all_.end() ? nullptr : &found->second;
}

void timing_list::add(const method& what, std::size_t bits, const frame_latency& found) {
    const tactnet::file_metadata key = key_of(what, bits, this_program());
    file_.add(nlohmann::ordered_json{{"settings", key},
                                     {"median", found.median},
                                     {"p99", found.p99},
                                     {"in_batch", found.in_batch},
                                     {"jitter", found.jitter}}
                  .dump());
    all_[key] = found;
}
