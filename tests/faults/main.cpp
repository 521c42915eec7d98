// An attack on the programs: every case is a fault that the world may have in store. See docs/rooms.md.
//
// Exit status: 0, 1 (a case was silent or aborted), 2 (bad arguments, or no attack was possible).

#include "groups.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <optional>
#include <random>
#include <stdexcept>
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
    group{"bit flips", 21, flip_bits, always},
    group{"flips in recordings", 8, flip_bits_of_recordings, needs_decoders},
    group{"two flips under a sum", 4, flip_two_bits_of_sums, needs_decoders},
    group{"values", 5, replace_values, needs_decoders},
    group{"cut files", 12, cut_files, needs_decoders},
    group{"kills", 8, kill_and_resume, always},
    group{"full disk", 5, fill_the_disk, small_disk},
    group{"limited files", 5, limit_files, always},
    group{"streams", 8, break_streams, needs_decoders},
    group{"resources", 6, take_resources, always},
    group{"clocks", 3, set_the_clock, clock_library},
    group{"arguments", 9, ask_for_nonsense, always},
    group{"file names", 6, name_strange_files, always},
};

struct arguments {
    programs which;
    std::uint64_t seed = std::random_device{}(); // another each run: reported, to be repeated
    std::size_t cases = 5000;
    std::string only{};
    std::optional<std::size_t> number{};
};

constexpr const char* usage =
    "usage: tactnet_attack [--short | --cases N] [--seed N] [--only GROUP [--case N]]\n"
    "                      [--tactnet FILE] [--decode FILE] [--stream FILE]\n\n"
    "Tries N faults (5000; --short: 400) on the programs, and tells which were silent or ended in disorder.\n"
    "Without --seed, it is another one each run, but for --short. A case depends on the seed, its group\n"
    "and its number alone: --only and --case repeat it.\n";

std::uint64_t number_in(const std::string& text) {
    if (text.empty() || text.size() > 18 || text.find_first_not_of("0123456789") != std::string::npos)
        throw std::invalid_argument("expected a number, found '" + text + "'");
    return std::stoull(text);
}

arguments read(int count, char** given) {
    arguments asked;
    asked.which = {TACTNET_PROGRAM, TACTNET_DECODE_PROGRAM, TACTNET_STREAM_PROGRAM};
    for (int i = 1; i < count; ++i) {
        const std::string option = given[i];
        if (option == "--short") {
            asked.cases = 400, asked.seed = 14; // a test is the same each run
            continue;
        }
        if (i + 1 == count)
            throw std::invalid_argument("expected an option and its value, found '" + option + "'");
        const std::string value = given[++i];
        if (option == "--cases")
            asked.cases = number_in(value);
        else if (option == "--seed")
            asked.seed = number_in(value);
        else if (option == "--only")
            asked.only = value;
        else if (option == "--case")
            asked.number = number_in(value);
        else if (option == "--tactnet")
            asked.which.tactnet = fs::absolute(value);
        else if (option == "--decode")
            asked.which.decode = fs::absolute(value);
        else if (option == "--stream")
            asked.which.stream = fs::absolute(value);
        else
            throw std::invalid_argument("there is no option '" + option + "'");
    }
    if (!asked.only.empty() &&
        std::none_of(groups.begin(), groups.end(), [&](const group& g) { return g.name == asked.only; }))
        throw std::invalid_argument("there is no group '" + asked.only + "'");
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
            found = of.attempt(s, number);
        } catch (const std::exception& error) { // what is left can break the attack itself
            found = s.silent(std::string("the attack itself: ") + error.what());
        }
        ++count.tried, ++done_;
        ++(found.is == verdict::handled  ? count.handled
           : found.is == verdict::silent ? count.silent
                                         : count.aborted);
        if (found.is != verdict::handled)
            std::printf("%s: %s\n  --seed %llu --only '%s' --case %zu\n      %s\n",
                        found.is == verdict::silent ? "silent" : "aborted", found.why.c_str(),
                        static_cast<unsigned long long>(asked_.seed), of.name.c_str(), number,
                        found.command.c_str());
        else if (asked_.number)
            std::printf("handled: %s\n", found.command.c_str());
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
    } catch (const std::invalid_argument& error) {
        std::fprintf(stderr, "tactnet_attack: %s\n%s", error.what(), usage);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "tactnet_attack: %s\n", error.what());
    }
    return 2;
}
