// Arguments that mean nothing, files that are named twice, names of files that are not what they seem, and
// names that are more than a name to somebody.

#include "groups.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <sstream>
#include <sys/stat.h>

namespace faults {
namespace {

using namespace std::string_literals;

words words_of(const std::string& text) {
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}

/// An option and its value, in the place of the one that the command has or at its end.
words with(words command, const std::string& option, const std::string& value) {
    const auto found = std::find(command.begin(), command.end(), option);
    if (found != command.end())
        *(found + 1) = value;
    else
        command.insert(command.end(), {option, value});
    return command;
}

void expect_no_escape(const scene& s, const ending& end) {
    s.expect((end.out + end.error).find('\x1b') == std::string::npos, "a terminal gets control characters");
}

/// Exit status 2, a message, and nothing changed.
void must_refuse(scene& s, const words& command, const std::string& what) {
    const auto before = files_in(s.folder);
    conditions under = without_pictures;
    under.patience = std::chrono::seconds(20);
    const ending end = s.run(command, under);
    s.expect(end.status == 2 && !end.error.empty(), what + ": expected to be refused, found " + end.text());
    s.expect(files_in(s.folder) == before, what + ": refused, but files were changed");
}

void number(scene& s) {
    words values = words_of("nan inf -inf -1 1e999 5x --5 -0.5 ٣ 1e- true");
    values.insert(values.end(), {"", " ", "1 2", "\n", "+ 1", "99999999999999999999999999"});
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
    if (value == values.back() && (option == "--rate" || option == "--checkpoint-every"))
        // A number, which has its consequences.
        return s.expect_message(s.run(with(command, option, value), without_pictures), option);
    must_refuse(s, with(command, option, value), option + " '" + value + "'");
}

void equal_names(scene& s) {
    s.bring("net");
    s.bring("svm-linear");
    fs::create_symlink("net", s.folder / "link");
    fs::create_hard_link(s.folder / "net", s.folder / "hard");
    fs::create_directory_symlink(".", s.folder / "here");
    fs::create_symlink("new", s.folder / "dangling");
    const std::array there{"net"s, "./net"s, "link"s, "hard"s, "here/net"s, "here/here/link"s};
    const std::array later{"new"s, "./new"s, "dangling"s, "here/new"s, "here/dangling"s};
    const std::string name = s.one_of(there), other = s.one_of(there), fresh = s.one_of(later);
    const std::vector<words> commands{
        s.made.tactnet({"export", "--weights", name, "--output", other}),
        s.made.train({"--epochs", "2", "--start", name, "--output", other}),
        s.made.train({"--epochs", "2", "--output", name, "--checkpoint", other, "--afresh"}),
        s.made.train({"--epochs", "2", "--output", "new", "--checkpoint", fresh}),
        s.made.train(
            {"--epochs", "2", "--start", name, "--output", "new", "--checkpoint", other, "--afresh"}),
    };
    must_refuse(s, s.one_of(commands), "equal names");
}

/// Words in any order: they may mean something, or not.
void any_words(scene& s) {
    s.bring("net");
    s.bring("sample.csv");
    words pool = words_of(
        "train evaluate classify export list simulate study recommend check --data --output --weights "
        "--epochs --rows --columns --method --seed --help --resume --afresh --results --namespace --packing "
        "--split --out --csv --map --picture --scene -- - 0 1 2 7 13 net sample.csv tactnet4 svm-rbf own out "
        ". / %s%n%x \xff\xfe \x1b[2J =x --data= --epochs=2 -h @net paper");
    pool.insert(pool.end(), {"", "a\nb", std::string(5000, 'a')});
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
    const ending end = s.run(command, without_pictures);
    s.expect_message(end, "any words");
    expect_no_escape(s, end);
}

/// Something at `place` that is no file to read.
std::string put_trap(scene& s, const fs::path& place) {
    fs::remove_all(place);
    const std::size_t kind = s.below(6);
    if (kind == 0) {
        static_cast<void>(::mkfifo(place.c_str(), 0666));
        return "a pipe";
    }
    if (kind == 1) {
        fs::create_directory(place);
        return "a folder";
    }
    const std::pair<const char*, fs::path> links[]{{"a dangling link", "nowhere"},
                                                   {"a link to itself", place.filename()},
                                                   {"an endless device", "/dev/zero"},
                                                   {"unreadable memory", "/proc/self/mem"}};
    const auto& [what, target] = links[kind - 2];
    fs::create_symlink(target, place);
    return what;
}

void strange_input(scene& s) {
    for (const char* name : {"net", "stopped.checkpoint", "data", "results", "simulated", "sample.csv"})
        s.bring(name);
    const std::string data = (s.folder / "data").string(), number = epochs;
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
    conditions under = without_pictures;
    under.patience = std::chrono::seconds(20);
    const ending end = s.run(chosen.command, under);
    // A link to nothing may be a name to write to. What is no folder next to those of classes, and a folder
    // within one, are passed over, as is documented.
    const bool may_do = (what == "a dangling link" && chosen.place != "trap") ||
                        chosen.place == "data/left" ||
                        (what == "a folder" && chosen.place == "data/left/image3.png");
    s.expect(end.status != 0 || may_do, what + " as " + chosen.place + " was taken for a file");
    s.expect_message(end, what + " as " + chosen.place);
}

void strange_output(scene& s) {
    s.bring("net");
    words names = words_of(
        "-x --output a'b a\"b a\\b \xff\xfe ä %s%n \x1b[2J . .. a/ .hidden * @x #x net.confusion.png");
    names.insert(names.end(),
                 {"|touch hacked;", "<touch hacked;", "a\nb", "$(touch hacked)", "`touch hacked`", "a b",
                  "a;touch hacked", "!touch hacked", "'; system 'touch hacked", "\t", "a\rb",
                  std::string(255, 'n'), std::string(300, 'n')});
    const std::string name = s.one_of(names);
    const std::vector<words> writers{
        s.made.train({"--epochs", epochs, "--output=" + name}),
        s.made.tactnet({"export", "--weights", "net", "--output=" + name}),
        s.made.evaluate({"--results=" + name}),
        s.made.tactnet({"simulate", "--per-class", "1", "--out=" + name}),
        s.made.train({"--epochs", "2", "--output=" + name + "/net"}),
        s.made.train({"--epochs", "2", "--output", "other", "--checkpoint=" + name}),
    };
    const std::size_t which = s.below(writers.size());
    conditions under; // with pictures: they are what names become commands in
    const ending end = s.run(writers[which], under);
    s.expect(!fs::exists(s.folder / "hacked"), "a name became a command");
    s.expect_message(end, "a strange name");
    if (end.status != 0)
        return;
    expect_no_escape(s, end);
    s.expect(which != 0 || bytes_of(s.folder / name) == bytes_of(s.made / "net"),
             "other weights under a strange name");
    s.expect(which >= 4 || fs::exists(s.folder / name), "nothing of that name, exit status 0");
}

} // namespace

void ask_for_nonsense(scene& s, std::size_t index) {
    constexpr std::array kinds{number, equal_names, any_words};
    kinds[index % kinds.size()](s);
}

void name_strange_files(scene& s, std::size_t number) {
    return number % 2 == 0 ? strange_input(s) : strange_output(s);
}

} // namespace faults
