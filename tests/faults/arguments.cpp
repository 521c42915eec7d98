// Arguments that mean nothing, and files that are named twice.

#include "groups.hpp"
#include "jobs.hpp"

#include <algorithm>
#include <array>

namespace faults {
namespace {

using namespace std::string_literals;

/// An option and its value, in the place of the one that the command has or at its end.
words with(words command, const std::string& option, const std::string& value) {
    const auto found = std::find(command.begin(), command.end(), option);
    if (found != command.end())
        *(found + 1) = value;
    else
        command.insert(command.end(), {option, value});
    return command;
}

/// Exit status 2, a message, and nothing changed.
finding must_refuse(scene& s, const words& command, const std::string& what) {
    const auto before = files_in(s.folder);
    conditions under;
    under.pictures = false;
    under.patience = std::chrono::seconds(20);
    const ending end = s.run(command, under);
    if (!end.orderly())
        return s.aborted(end);
    if (end.status != 2 || end.error.empty())
        return s.silent(what + ": expected to be refused, found " + end.text());
    if (files_in(s.folder) != before)
        return s.silent(what + ": refused, but files were changed");
    return s.handled();
}

finding number(scene& s) {
    const std::array values{"nan"s,
                            "inf"s,
                            "-inf"s,
                            "-1"s,
                            "1e999"s,
                            ""s,
                            " "s,
                            "5x"s,
                            "--5"s,
                            "1 2"s,
                            "-0.5"s,
                            "\n"s,
                            "٣"s,
                            "1e-"s,
                            "+ 1"s,
                            "true"s,
                            "99999999999999999999999999"s};
    const words train = s.made.train({"--epochs", "2", "--output", "out"}),
                evaluate = s.made.evaluate({"--results", "out"}), simulate = s.made.simulate("out");
    const std::vector<std::pair<words, words>> takers{
        {train,
         {"--rows", "--columns", "--seed", "--threads", "--epochs", "--batch", "--rate", "--validation",
          "--test", "--checkpoint-every", "--self-test"}},
        {evaluate,
         {"--rows", "--columns", "--seed", "--splits", "--jobs", "--epochs", "--batch", "--rate",
          "--validation", "--test"}},
        {simulate, {"--per-class", "--seed", "--threads"}},
        {s.made.tactnet({"list"}), {"--classes"}},
    };
    const auto& [command, options] = s.one_of(takers);
    const std::string option = s.one_of(options), value = s.one_of(values);
    if (value == values.back() && (option == "--rate" || option == "--checkpoint-every")) {
        conditions under; // a number, which has its consequences
        under.pictures = false;
        const ending end = s.run(with(command, option, value), under);
        if (!end.orderly())
            return s.aborted(end);
        return end.status != 0 && end.error.empty() ? s.silent("no message") : s.handled();
    }
    return must_refuse(s, with(command, option, value), option + " '" + value + "'");
}

finding equal_names(scene& s) {
    s.bring("net");
    s.bring("svm-linear");
    fs::create_symlink("net", s.folder / "link");
    fs::create_hard_link(s.folder / "net", s.folder / "hard");
    fs::create_directory_symlink(".", s.folder / "here");
    fs::create_symlink("new", s.folder / "dangling");
    const std::array there{"net"s, "./net"s, "link"s, "hard"s, "here/net"s, "here/here/link"s};
    const std::array later{"new"s, "./new"s, "dangling"s, "here/new"s, "here/dangling"s};
    const std::string name = s.one_of(there), other = s.one_of(there), fresh = s.one_of(later);
    switch (s.below(5)) {
    case 0:
        return must_refuse(s, s.made.tactnet({"export", "--weights", name, "--output", other}),
                           "equal names");
    case 1:
        return must_refuse(s, s.made.train({"--epochs", "2", "--start", name, "--output", other}),
                           "equal names");
    case 2:
        return must_refuse(
            s, s.made.train({"--epochs", "2", "--output", name, "--checkpoint", other, "--afresh"}),
            "equal names");
    case 3:
        return must_refuse(s, s.made.train({"--epochs", "2", "--output", "new", "--checkpoint", fresh}),
                           "equal names");
    default:
        return must_refuse(s,
                           s.made.train({"--epochs", "2", "--start", name, "--output", "new", "--checkpoint",
                                         other, "--afresh"}),
                           "equal names");
    }
}

/// Words in any order: they may mean something, or not.
finding any_words(scene& s) {
    s.bring("net");
    s.bring("sample.csv");
    const std::array pool{"train"s,      "evaluate"s,
                          "classify"s,   "export"s,
                          "list"s,       "simulate"s,
                          "study"s,      "recommend"s,
                          "check"s,      "--data"s,
                          "--output"s,   "--weights"s,
                          "--epochs"s,   "--rows"s,
                          "--columns"s,  "--method"s,
                          "--seed"s,     "--help"s,
                          "--resume"s,   "--afresh"s,
                          "--results"s,  "--namespace"s,
                          "--packing"s,  "--split"s,
                          "--out"s,      "--csv"s,
                          "--map"s,      "--picture"s,
                          "--scene"s,    "--"s,
                          "-"s,          ""s,
                          "0"s,          "1"s,
                          "2"s,          "7"s,
                          "13"s,         "net"s,
                          "sample.csv"s, "tactnet4"s,
                          "svm-rbf"s,    "own"s,
                          "out"s,        "."s,
                          "/"s,          "%s%n%x"s,
                          "\xff\xfe"s,   "a\nb"s,
                          "\x1b[2J"s,    std::string(5000, 'a'),
                          "=x"s,         "--data="s,
                          "--epochs=2"s, "-h"s,
                          "@net"s,       "paper"s};
    const auto& where = s.made.where();
    std::vector<fs::path> programs{where.tactnet, where.tactnet, where.tactnet};
    for (const fs::path& more : {where.decode, where.stream})
        if (!more.empty())
            programs.push_back(more);
    words command{s.one_of(programs).string()};
    if (s.below(2) == 0 && command[0] == where.tactnet.string())
        command = s.one_of(jobs(s.made)).command;
    for (std::size_t more = s.below(6); more > 0; --more)
        command.insert(command.begin() + 1 + static_cast<std::ptrdiff_t>(s.below(command.size())),
                       s.one_of(pool));
    conditions under;
    under.pictures = false;
    const ending end = s.run(command, under);
    if (!end.orderly())
        return s.aborted(end);
    if (end.status != 0 && end.error.empty())
        return s.silent("exit status " + std::to_string(end.status) + " without a word");
    for (const std::string* text : {&end.out, &end.error})
        if (text->find('\x1b') != std::string::npos)
            return s.silent("a terminal gets control characters");
    return s.handled();
}

} // namespace

finding ask_for_nonsense(scene& s, std::size_t index) {
    switch (index % 3) {
    case 0:
        return number(s);
    case 1:
        return equal_names(s);
    default:
        return any_words(s);
    }
}

} // namespace faults
