// Programs that are ended at any moment and go on, disks without room, streams that take nothing, clocks that
// are wrong, and systems that refuse what they are asked for.

#include "groups.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <sys/resource.h>
#include <unistd.h>
#if defined(__linux__)
#include <sched.h>
#include <sys/mount.h>
#endif

namespace faults {
namespace {

constexpr std::size_t page = 4096;

/// The least that lets the program start, so that what is refused is refused to it and not to the system. 0
/// if that is more than any program should need, as with an address sanitizer.
unsigned long least(const scene& s, unsigned long from, unsigned long step, int resource) {
    for (unsigned long most = from; most < from + 1000 * step; most += step) {
        conditions under;
        under.limited_user = true;
        under.limits = {{resource, most}};
        if (run(s.made.tactnet({"list"}), s.folder, under).done())
            return most;
    }
    return 0;
}

/// How the program goes on: with what there is.
words again(const scene& s, const job& what) {
    words command = what.command;
    if (fs::exists(s.folder / "net.checkpoint"))
        command.emplace_back("--resume");
    return command;
}

} // namespace

void kill_and_resume(scene& s, std::size_t number) {
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
            throw finding{verdict::aborted, whole.text()};
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
        const ending end = s.run_to_any_end(again(s, what), killed);
        if (end.done())
            break;
        if (end.hung || (end.signal != killed.signal && end.status != 130)) {
            s.expect_order(end);
            // Only a signal ends it: what there is can always be resumed.
            s.expect(false, what.name + ": what a killed one left is not readable: " + end.text());
        }
        expect_right(s, what, false, ", killed");
    }
    const ending end = s.run(again(s, what), quick);
    s.expect(end.done(), what.name + ": cannot go on: " + end.text());
    expect_right(s, what, true, ", after going on");
    const std::string left = litter_in(s.folder);
    s.expect(left.empty(), what.name + " leaves " + left);
}

std::string small_disk([[maybe_unused]] const programs& which) {
#if defined(__linux__)
    static const int problem = [] {
        // As root, or as one who may be root of a space of their own.
        const std::string user = std::to_string(::geteuid()), group = std::to_string(::getegid());
        if (::unshare(CLONE_NEWNS) != 0) {
            if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0)
                return errno;
            write_bytes("/proc/self/setgroups", "deny");
            write_bytes("/proc/self/uid_map", "0 " + user + " 1");
            write_bytes("/proc/self/gid_map", "0 " + group + " 1");
        }
        return ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 ? 0 : errno;
    }();
    return problem == 0 ? "" : std::string("no disk may be mounted: ") + std::strerror(problem);
#else
    return "needs a disk that only this program sees (Linux)";
#endif
}

void fill_the_disk([[maybe_unused]] scene& s, [[maybe_unused]] std::size_t number) {
#if defined(__linux__)
    const std::vector<job> writers = jobs(s.made, true);
    const job& what = writers[number % writers.size()];
    const bool pictures = number / writers.size() % 2 == 0;
    const std::string size = "size=" + std::to_string((1 + s.below(pictures ? 60 : 30)) * page);
    s.expect(::mount("tmpfs", s.folder.c_str(), "tmpfs", 0, (size + ",mode=777").c_str()) == 0,
             std::string("the attack itself: mount: ") + std::strerror(errno));
    struct mounted {
        const fs::path& folder;
        ~mounted() { ::umount2(folder.c_str(), MNT_DETACH); }
    } const disk{s.folder};
    s.note(" on a tmpfs of " + size);
    conditions under;
    under.pictures = pictures;
    try {
        attempt(s, what, under);
    } catch (const std::exception&) { // no room even for what it reads
    }
#endif
}

void limit_files(scene& s, std::size_t number) {
    const std::vector<job> writers = jobs(s.made, true);
    conditions under;
    under.pictures = number / writers.size() % 4 == 0;
    under.limits = {{RLIMIT_FSIZE, s.below(s.below(2) == 0 ? 4000 : 100'000)}};
    attempt(s, writers[number % writers.size()], under);
}

void break_streams(scene& s, std::size_t number) {
    const std::vector<job> all = jobs(s.made);
    constexpr std::array kinds{stream::usual, stream::closed, stream::full, stream::broken, stream::null};
    conditions under;
    // All pairs of kinds in any 25 cases, each with another job later.
    const std::size_t pairs = kinds.size() * kinds.size(), which = (7 * number + number / 100) % pairs;
    under.out = kinds[which % kinds.size()];
    under.error = kinds[which / kinds.size()];
    const job& what = all[number % all.size()];
    if (what.input.empty() || s.below(2) == 0)
        under.in = s.one_of(
            std::array{stream::usual, stream::closed, stream::broken, stream::null}); // full: endless
    under.pictures = s.below(8) == 0;
    attempt(s, what, under, under.error == stream::usual);
}

void take_resources(scene& s, std::size_t number) {
    const std::vector<job> all = jobs(s.made);
    conditions under;
    under.limited_user = true;
    under.pictures = s.below(4) == 0;
    switch (number / all.size() % 4) {
    case 0: {
        constexpr unsigned long step = 1UL << 20U;
        static const unsigned long start = least(s, step, step, RLIMIT_AS);
        if (start == 0)
            return;
        under.limits = {{RLIMIT_AS, start + s.below(s.below(2) == 0 ? 4 * step : 60 * step)}};
        break;
    }
    case 2: // from what any program needs to what is enough
        under.limits = {{RLIMIT_STACK, 32'768 + s.below(1024) * 4096}};
        break;
    case 1:
        under.limits = {{RLIMIT_NPROC, 1 + s.below(4)}};
        break;
    default: {
        static const unsigned long start = least(s, 3, 1, RLIMIT_NOFILE);
        under.limits = {{RLIMIT_NOFILE, start + s.below(8)}};
    }
    }
    attempt(s, all[number % all.size()], under);
}

std::string clock_library(const programs& which) {
    if (std::string(TACTNET_CLOCK_LIBRARY).empty())
        return "needs a library that is loaded before others (Linux)";
    conditions under;
    under.clock = "still";
    const ending end = run({which.tactnet.string(), "list"}, "/", under);
    return end.done() ? "" : "the program does not start with another clock: " + end.text();
}

void set_the_clock(scene& s, std::size_t number) {
    constexpr std::array modes{"still", "backwards", "leaps", "slow", "early", "late", "refused"};
    std::vector<job> all = jobs(s.made);
    conditions under;
    under.clock = modes[number % modes.size()];
    under.pictures = s.below(8) == 0;
    if (s.below(4) != 0)
        return attempt(s, s.one_of(all), under);
    // What was measured by a wrong clock must not be in the way of what comes later.
    s.expect_message(s.run(s.made.study({"--results", "study"}), under), "study");
    const ending later = s.run(s.made.study({"--results", "study"}));
    s.expect(later.done(), "study, with the right clock again: " + later.text());
}

} // namespace faults
