#pragma once

// What a case of the attack has: a folder of its own, random numbers, and files that were made when
// nothing was wrong, with what came of them.

#include "run.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <support/files/temporary_folder.hpp>
#include <vector>

namespace faults {

struct programs {
    fs::path tactnet, decode, stream; ///< the last two may be empty
};

/// Small recordings of every kind, and a network for a stream of them, without damage. By file name:
/// sample.fsx, sample.csv, sample.mp, own.stream, plain.stream, stream.net.
std::map<std::string, std::string> recordings();
/// The network of stream.net, whose fourth class has a name of choice, as it stands within quotes in JSON.
std::string network(const std::string& fourth_class = "object3");

/// Images of three classes, and the results of an undisturbed program; in a folder of their own.
class materials {
public:
    explicit materials(programs which);

    const programs& where() const { return programs_; }
    fs::path folder() const { return folder_.path() / "made"; }
    fs::path operator/(const std::string& name) const { return folder() / name; }
    /// A new empty folder in the place of the last one, writable for everyone.
    fs::path new_folder() const;

    words tactnet(words arguments, const words& more = {}) const;
    /// `train` of seconds or less, of a network.
    words train(const words& more, const std::string& data = "") const;
    words evaluate(const words& more) const;
    /// `study` of one network by two recipes.
    words study(const words& more) const;
    words simulate(const std::string& out) const;
    /// `classify` of some of the images.
    words classify(const std::string& weights) const;

    std::string image() const { return (folder() / "data" / "left" / "image0.png").string(); }

private:
    programs programs_;
    support::temporary_folder folder_;
};

inline constexpr const char* epochs = "60";

enum class verdict { handled, silent, aborted };

/// Thrown for a case that the programs did not handle. `why` is for people.
struct finding {
    verdict is = verdict::handled;
    std::string why{};
};

/// One case. What it draws depends on the seed, the group's name and the case's number alone.
class scene {
public:
    scene(const materials& of, std::uint64_t seed, const std::string& group, std::size_t number);

    const materials& made;
    const fs::path folder;

    std::size_t below(std::size_t bound) { return static_cast<std::size_t>(engine_() % bound); }
    template <class Range>
    const auto& one_of(const Range& range) {
        return range[below(std::size(range))];
    }

    /// Copies one of the files or folders that were made into this case's folder.
    void bring(const std::string& name) const;
    /// Runs, and notes the command. Throws a finding unless the program ends in good order.
    ending run(const words& command, const conditions& under = {});
    /// Runs, and notes the command, however the program ends.
    ending run_to_any_end(const words& command, const conditions& under);
    void expect_order(const ending& end) const {
        if (!end.orderly())
            throw finding{verdict::aborted, end.text()};
    }
    /// Throws a finding for a program that has failed without a message.
    void expect_message(const ending& end, const std::string& what) const {
        expect(end.status == 0 || !end.error.empty(), what + ": no message, " + end.text());
    }
    /// Throws a finding unless it is `right`.
    void expect(bool right, const std::string& otherwise) const {
        if (!right)
            throw finding{verdict::silent, otherwise};
    }

    /// For the report: what was run, and under which conditions.
    std::string command() const { return command_ + conditions_; }
    void note(const std::string& conditions) { conditions_ = conditions; }

private:
    std::mt19937_64 engine_;
    std::string command_, conditions_;
};

/// The lines of a text, without their ends; and such lines as a text.
std::vector<std::string> lines_of(const std::string& text);
std::string text_of(const std::vector<std::string>& lines);
/// The accuracies and confusions in a list of results, without times; sorted.
std::vector<std::string> results_in(const fs::path& list);
/// Names and contents of the files in a folder and its subfolders that `takes(name)`.
std::map<std::string, std::string> files_in(const fs::path& folder);
/// The first of what killed programs leave behind, or nothing.
std::string litter_in(const fs::path& folder);

} // namespace faults
