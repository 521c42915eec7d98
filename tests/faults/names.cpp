// Names of files that are not what they seem, and names that are more than a name to somebody.

#include "groups.hpp"
#include "jobs.hpp"

#include <array>
#include <sys/stat.h>

namespace faults {
namespace {

using namespace std::string_literals;

/// Something at `place` that is no file to read.
std::string put_trap(scene& s, const fs::path& place) {
    fs::remove_all(place);
    switch (s.below(6)) {
    case 0:
        static_cast<void>(::mkfifo(place.c_str(), 0666));
        return "a pipe";
    case 1:
        fs::create_directory(place);
        return "a folder";
    case 2:
        fs::create_symlink("nowhere", place);
        return "a dangling link";
    case 3:
        fs::create_symlink(place.filename(), place);
        return "a link to itself";
    case 4:
        fs::create_symlink("/dev/zero", place);
        return "an endless device";
    default:
        fs::create_symlink("/proc/self/mem", place);
        return "unreadable memory";
    }
}

finding strange_input(scene& s) {
    for (const char* name : {"net", "stopped.checkpoint", "data", "results", "simulated", "sample.csv"})
        s.bring(name);
    const std::string data = (s.folder / "data").string(), number = std::to_string(epochs);
    const auto& where = s.made.where();
    struct reader {
        std::string place;
        words command;
    };
    std::vector<reader> readers{
        {"trap", s.made.classify("trap")},
        {"trap", s.made.tactnet({"classify", "--weights", "net", "trap"})},
        {"trap", s.made.tactnet({"classify", "--weights", "net", "--classes", "trap", s.made.image()})},
        {"trap", s.made.tactnet({"export", "--weights", "trap", "--output", "out"})},
        {"trap", s.made.train({"--epochs", "2", "--start", "trap", "--output", "out"})},
        {"trap", s.made.train({"--epochs", "2", "--output", "out"}, "trap")},
        {"trap", s.made.train({"--epochs", number, "--output", "out", "--checkpoint", "trap", "--resume"})},
        {"data/left/image3.png", s.made.train({"--epochs", "2", "--output", "out"}, data)},
        {"data/left", s.made.train({"--epochs", "2", "--output", "out"}, data)},
        {"simulated/simulation.json", s.made.simulate("simulated")},
        {"results/evaluation.jsonl", s.made.evaluate({"--results", "results"})},
        {"trap", s.made.tactnet({"evaluate", "--data", "data", "--weights", "trap"})},
    };
    if (!where.decode.empty()) {
        readers.push_back({"trap", {where.decode.string(), "trap"}});
        readers.push_back({"trap", {where.decode.string(), "--map", "trap", "sample.csv"}});
    }
    if (!where.stream.empty())
        readers.push_back({"trap", {where.stream.string(), "trap"}});
    const reader& chosen = s.one_of(readers);
    const std::string what = put_trap(s, s.folder / chosen.place);
    conditions under;
    under.pictures = false;
    under.patience = std::chrono::seconds(20);
    under.limits = {};
    const ending end = s.run(chosen.command, under);
    if (!end.orderly())
        return s.aborted(end);
    // A link to nothing may be a name to write to. What is no folder next to those of classes, and a folder
    // within one, are passed over, as is documented.
    const bool may_do = (what == "a dangling link" && chosen.place != "trap") ||
                        chosen.place == "data/left" ||
                        (what == "a folder" && chosen.place == "data/left/image3.png");
    if (end.status == 0 && !may_do)
        return s.silent(what + " as " + chosen.place + " was taken for a file");
    if (end.status != 0 && end.error.empty())
        return s.silent(what + " as " + chosen.place + ": no message");
    return s.handled();
}

finding strange_output(scene& s) {
    s.bring("net");
    const std::array names{"|touch hacked;"s,
                           "<touch hacked;"s,
                           "-x"s,
                           "--output"s,
                           "a\nb"s,
                           "$(touch hacked)"s,
                           "`touch hacked`"s,
                           "a'b"s,
                           "a\"b"s,
                           "a b"s,
                           "a\\b"s,
                           "\xff\xfe"s,
                           "ä"s,
                           "%s%n"s,
                           "a;touch hacked"s,
                           "!touch hacked"s,
                           "\x1b[2J"s,
                           "."s,
                           ".."s,
                           "a/"s,
                           ".hidden"s,
                           std::string(255, 'n'),
                           std::string(300, 'n'),
                           "\t"s,
                           "*"s,
                           "'; system 'touch hacked"s,
                           "@x"s,
                           "net.confusion.png"s,
                           "a\rb"s,
                           "#x"s};
    const std::string name = s.one_of(names);
    const std::vector<words> writers{
        s.made.train({"--epochs", std::to_string(epochs), "--output=" + name}),
        s.made.tactnet({"export", "--weights", "net", "--output=" + name}),
        s.made.evaluate({"--results=" + name}),
        s.made.tactnet({"simulate", "--per-class", "1", "--out=" + name}),
        s.made.train({"--epochs", "2", "--output=" + name + "/net"}),
        s.made.train({"--epochs", "2", "--output", "other", "--checkpoint=" + name}),
    };
    const std::size_t which = s.below(writers.size());
    conditions under; // with pictures: they are what names become commands in
    const ending end = s.run(writers[which], under);
    if (!end.orderly())
        return s.aborted(end);
    if (fs::exists(s.folder / "hacked"))
        return s.silent("a name became a command");
    if (end.status != 0)
        return end.error.empty() ? s.silent("no message") : s.handled();
    if (end.error.find('\x1b') != std::string::npos || end.out.find('\x1b') != std::string::npos)
        return s.silent("a terminal gets control characters");
    if (which == 0 && bytes_of(s.folder / name) != bytes_of(s.made / "net"))
        return s.silent("other weights under a strange name");
    if (which < 4 && !fs::exists(s.folder / name))
        return s.silent("nothing of that name, exit status 0");
    return s.handled();
}

} // namespace

finding name_strange_files(scene& s, std::size_t number) {
    return number % 2 == 0 ? strange_input(s) : strange_output(s);
}

} // namespace faults
