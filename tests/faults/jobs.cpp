#include "groups.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <tuple>

namespace faults {
namespace {

/// A file that must be as it was made, and be there if all was done.
std::string differs(const materials& made, const std::string& original, const fs::path& left, bool done) {
    if (!fs::exists(left))
        return done ? left.filename().string() + " is missing" : "";
    return bytes_of(left) == bytes_of(made / original) ? "" : left.filename().string() + " is another one";
}

/// Why one of these files differs from what was made; empty if none does.
auto as_made(const words& names) {
    return [=](const materials& made, const fs::path& folder, bool done) {
        std::string problem;
        for (const std::string& name : names)
            if (problem.empty())
                problem = differs(made, name, folder / name, done);
        return problem;
    };
}
std::string results(const materials& made, const fs::path& folder, bool done) {
    const auto right = results_in(made / "results/evaluation.jsonl"),
               left = results_in(folder / "results/evaluation.jsonl");
    if (!std::includes(right.begin(), right.end(), left.begin(), left.end()))
        return "evaluation.jsonl has other results";
    if (done && left.size() != right.size())
        return "results are missing in evaluation.jsonl";
    for (const char* table : {"table.csv", "table.jsonl"})
        if (done && bytes_of(folder / "results" / table).empty())
            return std::string(table) + " is missing";
    return differs(made, "results/confusion_tactnet4_7x13.csv",
                   folder / "results/confusion_tactnet4_7x13.csv", done);
}
std::string images(const materials& made, const fs::path& folder, bool done) {
    static const auto right = files_in(made / "simulated");
    if (!fs::exists(folder / "simulated"))
        return done ? "nothing was written" : "";
    auto left = files_in(folder / "simulated");
    std::erase_if(left, [](const auto& file) { return file.first.find(".tactnet-") != std::string::npos; });
    for (const auto& [name, bytes] : left)
        if (const auto same = right.find(name); same == right.end() || same->second != bytes)
            return name + " is another one";
    return done && left.size() != right.size() ? "images are missing" : "";
}

/// Why a report that is left is not what an undisturbed program leaves; empty if all is well.
std::string wrong_among_reports(const fs::path& folder) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        // What is on its way, or was tried, is not yet under its name.
        if (!entry.is_regular_file() || entry.path().string().find("/.tactnet-") != std::string::npos)
            continue;
        const std::string bytes = bytes_of(entry.path());
        if (name.ends_with(".png") &&
            bytes.find("IEND", bytes.size() < 12 ? 0 : bytes.size() - 12) == std::string::npos)
            return name + " is no whole picture";
        const bool text = name.ends_with(".csv") || name.ends_with(".hpp") || name == "table.jsonl";
        if (text && !bytes.ends_with('\n'))
            return name + " does not end with its last line";
    }
    return "";
}

} // namespace

void expect_right(const scene& s, const job& what, bool done, const std::string& when) {
    const std::string wrong = what.wrong(s.made, s.folder, done);
    s.expect(wrong.empty(), what.name + when + ": " + wrong);
    const std::string report = wrong_among_reports(s.folder);
    s.expect(report.empty(), what.name + when + ": " + report);
}

std::vector<job> jobs(const materials& made, bool only_writers) {
    const std::string data = (made / "data").string();
    const auto network = as_made({"net", "net.confusion.csv", "net.learning.csv"});
    std::vector<job> all;
    const auto add = [&](const std::string& name, const words& command, const words& brings = {},
                         bool draws = false, const std::string& input = "") -> job& {
        return all.emplace_back(job{name, command, brings, input, true, draws, as_made({})});
    };
    add("train", made.train({"--epochs", epochs, "--output", "net"}), {}, true).wrong = network;
    add("train with checkpoints",
        made.train({"--epochs", epochs, "--output", "net", "--checkpoint-every", "0.0000001"}), {}, true)
        .wrong = network;
    add("train an SVM",
        made.tactnet({"train", "--data", data, "--method", "svm-rbf", "--rows", "7", "--columns", "13",
                      "--seed", "5", "--output", "svm-rbf"}),
        {}, true)
        .wrong = as_made({"svm-rbf", "svm-rbf.confusion.csv"});
    add("evaluate", made.evaluate({"--results", "results"}), {}, true).wrong = results;
    job& exported =
        add("export", made.tactnet({"export", "--weights", "net", "--output", "net.hpp"}), {"net"});
    exported.prints = false, exported.wrong = as_made({"net.hpp"});
    add("simulate", made.simulate("simulated")).wrong = images;
    if (only_writers)
        return all;
    add("go on",
        made.train({"--epochs", epochs, "--output", "net", "--checkpoint", "stopped.checkpoint", "--resume"}),
        {"stopped.checkpoint"});
    add("evaluate weights", made.tactnet({"evaluate", "--data", data, "--weights", "net"}), {"net"}, true);
    add("classify", made.classify("net"), {"net"});
    add("list", made.tactnet({"list"}));
    add("check", made.tactnet({"check", "--data", data}));
    add("help", made.tactnet({"train", "--help"}));
    if (!made.where().decode.empty()) {
        const std::string decode = made.where().decode.string();
        add("decode", {decode, "--csv", "sample.csv"}, {"sample.csv"});
        add("describe", {decode, "sample.fsx"}, {"sample.fsx"});
        add("decoder's help", {decode, "--help"});
    }
    if (!made.where().stream.empty())
        for (const auto& [name, kind, options] : {std::tuple{"own", "own", words{"own"}},
                                                  {"plain", "plain", {}},
                                                  {"live", "own", {"own", "--air", "2", "--json"}},
                                                  {"picture", "plain", {"--picture", "--air", "1"}}}) {
            words command{made.where().stream.string(), (made / "stream.net").string()};
            command.insert(command.end(), options.begin(), options.end());
            add(std::string("stream, ") + name, command, {}, false,
                bytes_of(made / (std::string(kind) + ".stream")));
        }
    return all;
}

void attempt(scene& s, const job& what, conditions under, bool heard) {
    for (const std::string& name : what.brings)
        s.bring(name);
    under.input = what.input;
    const ending end = s.run(what.command, under);
    if (heard)
        s.expect_message(end, what.name);
    const bool done = end.status == 0, lost = under.out != stream::usual && under.out != stream::null;
    s.expect(!(done && what.prints && lost), what.name + ": its results were lost, exit status 0");
    const bool input_lost = under.in != stream::usual && !what.input.empty();
    s.expect(!(done && what.prints && under.out == stream::usual && end.out.empty()),
             what.name + ": printed nothing" + (input_lost ? " of no input" : ""));
    expect_right(s, what, done, " (" + end.text() + ")");
    if (done && what.draws && under.pictures && heard) {
        const auto left = files_in(s.folder);
        const bool drawn = std::any_of(left.begin(), left.end(), [](const auto& file) {
            return file.first.ends_with("confusion.png") ||
                   (file.first.find("confusion_") != std::string::npos && file.first.ends_with(".png"));
        });
        static const bool there_is_gnuplot = fs::exists(s.made / "net.confusion.png");
        const bool reported = std::ranges::any_of(std::array{"is not drawn", "warning"}, [&](auto* word) {
            return end.error.find(word) != std::string::npos;
        });
        s.expect(drawn || reported || !there_is_gnuplot, what.name + ": no picture, and no word about it");
    }
}

} // namespace faults
