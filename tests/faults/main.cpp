// An attack on the programs: every case is a fault that the world may have in store. See
// docs/contribute/rooms.md.
//
// Exit status: 0, 1 (a case was silent or aborted), 2 (bad arguments, or no attack was possible).

#include "groups.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <random>
#include <sys/stat.h>

using namespace faults;

namespace {

std::string always(const programs&) {
    return "";
}
std::string needs_decoders(const programs& which) {
    return which.decode.empty() || which.stream.empty() ? "tactnet_decode and tactnet_stream were not given"
                                                        : "";
}

// Shares are of 100.
const std::array groups{
    group{"bit flips", 13, flip_bits, always},
    group{"flips in recordings", 8, flip_bits_of_recordings, needs_decoders},
    group{"two flips under a sum", 4, flip_two_bits_of_sums, needs_decoders},
    group{"values", 5, replace_values, needs_decoders},
    group{"cut files", 7, cut_files, needs_decoders},
    group{"kills", 8, kill_and_resume, always},
    group{"full disk", 5, fill_the_disk, small_disk},
    group{"limited files", 5, limit_files, always},
    group{"streams", 8, break_streams, needs_decoders},
    group{"resources", 6, take_resources, always},
    group{"clocks", 3, set_the_clock, clock_library},
    group{"arguments", 6, ask_for_nonsense, always},
    group{"file names", 6, name_strange_files, always},
    group{"hostile", 7, say_hostile_things, always},
    group{"tables", 3, spoil_tables, always},
    group{"archives", 3, spoil_archives, needs_decoders},
    group{"descriptions", 3, spoil_descriptions, needs_decoders},
};

struct arguments {
    programs which;
    std::uint64_t seed = std::random_device{}(); // another each run: reported, to be repeated
    std::size_t cases = 5000;
    std::string only{};
    std::optional<std::size_t> number{};
};

/// Ends the program for bad arguments, and for --help.
arguments read(int count, char** given) {
    arguments asked;
    asked.which = {TACTNET_PROGRAM, TACTNET_DECODE_PROGRAM, TACTNET_STREAM_PROGRAM};
    CLI::App app(
        "Tries faults on the programs, and reports which were silent or ended in disorder. A case depends on "
        "the seed, its group and its number alone: --only and --case repeat it.");
    std::vector<std::string> names;
    for (const group& g : groups)
        names.push_back(g.name);
    // CLI11 by itself takes octal and negative numbers.
    const CLI::Validator digits(
        [](const std::string& text) -> std::string {
            const bool right = text == "0" || (!text.empty() && text.size() <= 18 && text[0] != '0' &&
                                               text.find_first_not_of("0123456789") == std::string::npos);
            return right ? "" : "expected a whole number, found '" + text + "'";
        },
        "NUMBER");
    bool is_short = false;
    app.add_flag("--short", is_short, "400 cases of a seed that is the same each run, for a test");
    auto* const cases =
        app.add_option("--cases", asked.cases, "Number of cases (default: 5000)")->check(digits);
    auto* const seed =
        app.add_option("--seed", asked.seed, "Seed (default: another one each run)")->check(digits);
    auto* const only = app.add_option("--only", asked.only, "One group alone")->check(CLI::IsMember(names));
    app.add_option("--case", asked.number, "One case of that group alone")->needs(only)->check(digits);
    app.add_option("--tactnet", asked.which.tactnet, "The program");
    app.add_option("--decode", asked.which.decode, "The example that reads recordings");
    app.add_option("--stream", asked.which.stream, "The example that reads a stream");
    try {
        app.parse(count, given);
    } catch (const CLI::ParseError& error) {
        std::exit(app.exit(error) == 0 ? 0 : 2);
    }
    if (is_short && cases->count() == 0)
        asked.cases = 400;
    if (is_short && seed->count() == 0)
        asked.seed = 14;
    for (fs::path* file : {&asked.which.tactnet, &asked.which.decode, &asked.which.stream})
        if (!file->empty())
            *file = fs::absolute(*file);
    return asked;
}

struct tally {
    std::size_t tried = 0, handled = 0, silent = 0, aborted = 0;
    std::string left_out{};
};

class attack {
public:
    explicit attack(const arguments& asked) : asked_(asked), made_(asked.which) {}

    bool all_well() {
        std::array<std::size_t, groups.size()> counts{};
        for (std::size_t g = 0; g < groups.size(); ++g) {
            if (!asked_.only.empty() && groups[g].name != asked_.only)
                continue;
            tallies_[g].left_out = groups[g].missing(asked_.which);
            if (tallies_[g].left_out.empty())
                counts[g] = asked_.number ? 1
                            : asked_.only.empty()
                                ? std::max<std::size_t>(1, asked_.cases * groups[g].share / 100)
                                : asked_.cases;
            all_ += counts[g];
        }
        for (std::size_t g = 0; g < groups.size(); ++g)
            for (std::size_t n = 0; n < counts[g]; ++n)
                attempt(groups[g], tallies_[g], asked_.number.value_or(n));
        return report();
    }

private:
    void attempt(const group& of, tally& count, std::size_t number) {
        scene s(made_, asked_.seed, of.name, number);
        finding found;
        try {
            of.attempt(s, number);
        } catch (const finding& thrown) {
            found = thrown;
        } catch (const std::exception& error) { // what is left can break the attack itself
            found = {verdict::silent, std::string("the attack itself: ") + error.what()};
        }
        ++count.tried, ++done_;
        ++(found.is == verdict::handled  ? count.handled
           : found.is == verdict::silent ? count.silent
                                         : count.aborted);
        if (found.is != verdict::handled)
            std::printf("%s: %s\n  --seed %llu --only '%s' --case %zu\n      %s\n",
                        found.is == verdict::silent ? "silent" : "aborted", found.why.c_str(),
                        static_cast<unsigned long long>(asked_.seed), of.name.c_str(), number,
                        s.command().c_str());
        else if (asked_.number)
            std::printf("handled: %s\n", s.command().c_str());
        const std::chrono::duration<double> took = clock::now() - start_;
        if (done_ == all_ || took - shown_ > std::chrono::seconds(5)) {
            shown_ = took;
            std::fprintf(stderr, "%zu of %zu cases (%s), %.0f s, %.0f s left\n", done_, all_, of.name.c_str(),
                         took.count(),
                         took.count() / static_cast<double>(done_) * static_cast<double>(all_ - done_));
        }
        std::fflush(stdout);
    }

    bool report() const {
        tally sum;
        std::printf("\n%-20s %7s %7s %7s %7s\n", "group", "tried", "handled", "silent", "aborted");
        const auto line = [](const char* name, const tally& t) {
            if (t.left_out.empty())
                std::printf("%-20s %7zu %7zu %7zu %7zu\n", name, t.tried, t.handled, t.silent, t.aborted);
            else
                std::printf("%-20s left out: %s\n", name, t.left_out.c_str());
        };
        for (std::size_t g = 0; g < groups.size(); ++g) {
            const tally& t = tallies_[g];
            sum.tried += t.tried, sum.handled += t.handled, sum.silent += t.silent, sum.aborted += t.aborted;
            line(groups[g].name.c_str(), t);
        }
        line("all", sum);
        std::printf("seed %llu\n", static_cast<unsigned long long>(asked_.seed));
        return sum.silent + sum.aborted == 0;
    }

    using clock = std::chrono::steady_clock;
    const arguments& asked_;
    const clock::time_point start_ = clock::now();
    std::chrono::duration<double> shown_{0};
    std::size_t all_ = 0, done_ = 0;
    std::array<tally, groups.size()> tallies_{};
    materials made_;
};

} // namespace

int main(int count, char** given) {
    std::signal(SIGPIPE, SIG_IGN);
    ::umask(0);
    try {
        const arguments asked = read(count, given);
        return attack(asked).all_well() ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "tactnet_attack: %s\n", error.what());
        return 2;
    }
}
