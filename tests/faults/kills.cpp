// Programs that are ended at any moment, and go on.

#include "groups.hpp"
#include "jobs.hpp"

#include <array>
#include <csignal>

namespace faults {
namespace {

/// How the program goes on: with what there is.
words again(const scene& s, const job& what) {
    words command = what.command;
    if (fs::exists(s.folder / "net.checkpoint"))
        command.emplace_back("--resume");
    return command;
}

} // namespace

finding kill_and_resume(scene& s, std::size_t number) {
    const std::vector<job> writers = jobs(s.made, true);
    const job& what = writers[number % writers.size()];
    for (const std::string& name : what.brings)
        s.bring(name);
    conditions quick;
    quick.pictures = number / writers.size() % 4 == 0; // they take most of the time
    // How long it takes here, measured once: a moment within is then drawn from the seed.
    static std::map<std::pair<std::string, bool>, std::chrono::microseconds> took;
    auto& length = took[{what.name, quick.pictures}];
    if (length.count() == 0) {
        const ending whole = run(what.command, s.folder, quick);
        if (!whole.done())
            return s.aborted(whole);
        length = whole.took;
        s.made.new_folder();
        for (const std::string& name : what.brings)
            s.bring(name);
    }
    constexpr std::array<int, 5> signals{SIGKILL, SIGKILL, SIGINT, SIGTERM, SIGHUP};
    for (std::size_t kills = 1 + s.below(3); kills > 0; --kills) {
        conditions killed = quick;
        killed.signal = signals[s.below(signals.size())];
        killed.after = length * static_cast<int>(s.below(1000)) / 1000;
        const ending end = s.run(again(s, what), killed);
        const bool by_that = !end.hung && (end.signal == killed.signal || end.status == 130);
        if (end.done())
            break;
        if (!by_that && !end.orderly())
            return s.aborted(end);
        // Only a signal ends it: what there is can always be resumed.
        if (!by_that)
            return s.silent(what.name + ": what a killed one left is not readable: " + end.text());
        if (const std::string problem = what.wrong(s.made, s.folder, false); !problem.empty())
            return s.silent(what.name + ", killed: " + problem);
        if (const std::string problem = wrong_among_reports(s.folder); !problem.empty())
            return s.silent(what.name + ", killed: " + problem);
    }
    const ending end = s.run(again(s, what), quick);
    if (!end.orderly())
        return s.aborted(end);
    if (end.status != 0)
        return s.silent(what.name + ": cannot go on: " + end.text());
    if (const std::string problem = what.wrong(s.made, s.folder, true); !problem.empty())
        return s.silent(what.name + ", after going on: " + problem);
    if (const std::string left = litter_in(s.folder); !left.empty())
        return s.silent(what.name + " leaves " + left);
    return s.handled();
}

} // namespace faults
