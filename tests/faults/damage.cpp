// Bits flipped in files, and files cut short.

#include "groups.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <functional>
#include <string_view>

namespace faults {
namespace {

/// A file, how it is read, and what must come out of it unless damage is reported.
struct reading {
    const char* file;   ///< in the folder of what was made, or inside a folder there
    const char* folder; ///< brought whole, if it is inside one
    words (*command)(const materials&);
    /// What came out, of `end` and of what stands in the folder now.
    std::string (*outcome)(const ending& end, const fs::path& folder);
    bool summed; ///< every flip must be reported, also one without effect here
};

std::string printed(const ending& end, const fs::path&) {
    return end.out;
}
std::string weights_of(const ending&, const fs::path& folder) {
    return bytes_of(folder / "net");
}
std::string results_of(const ending&, const fs::path& folder) {
    return text_of(results_in(folder / "results" / "evaluation.jsonl"));
}
std::string images_of(const ending&, const fs::path& folder) {
    std::string all;
    for (const auto& [name, bytes] : files_in(folder / "simulated"))
        if (name.ends_with(".png"))
            all += name + bytes;
    return all;
}

/// The table of a study, and the same for programs.
std::string table_of(const ending& end, const fs::path& folder) {
    return end.out + bytes_of(folder / "study" / "study.csv");
}
words report(const materials& m) {
    return m.study({"--results", "study", "--report-only"});
}

const std::array<reading, 10> readings{{
    {"net", nullptr, [](const materials& m) { return m.classify("net"); }, printed, true},
    {"untested", nullptr, [](const materials& m) { return m.classify("untested"); }, printed, true},
    {"svm-rbf", nullptr, [](const materials& m) { return m.classify("svm-rbf"); }, printed, true},
    {"svm-linear", nullptr, [](const materials& m) { return m.classify("svm-linear"); }, printed, true},
    {"stopped.checkpoint", nullptr,
     [](const materials& m) {
         return m.train(
             {"--epochs", epochs, "--output", "net", "--checkpoint", "stopped.checkpoint", "--resume"});
     },
     weights_of, true},
    {"results/evaluation.jsonl", "results",
     [](const materials& m) {
         return m.evaluate({"--results", "results"});
     },
     results_of, false},
    {"simulated/simulation.json", "simulated", [](const materials& m) { return m.simulate("simulated"); },
     images_of, false},
    {"study/study.jsonl", "study",
     [](const materials& m) {
         return m.tactnet({"recommend", "--results", "study"});
     },
     printed, true},
    {"study/evaluation.jsonl", "study", report, table_of, true},
    {"study/timings.jsonl", "study", report, table_of, true},
}};

/// What comes out of the file as it was made.
const std::string& undamaged(scene& s, const reading& r) {
    static std::map<const reading*, std::string> kept;
    const auto found = kept.find(&r);
    if (found != kept.end())
        return found->second;
    if (r.outcome == weights_of)
        return kept[&r] = bytes_of(s.made / "net");
    if (r.outcome == results_of)
        return kept[&r] = results_of({}, s.made.folder());
    if (r.outcome == images_of)
        return kept[&r] = images_of({}, s.made.folder());
    const ending end = run(r.command(s.made), s.made.folder(), without_pictures);
    return kept[&r] = r.outcome(end, s.made.folder());
}

void read_damaged(scene& s, const reading& r, const std::string& damage,
                  const std::function<std::string(const std::string&)>& damaged, bool must_report) {
    const std::string& right = undamaged(s, r);
    s.bring(r.folder != nullptr ? r.folder : r.file);
    write_bytes(s.folder / r.file, damaged(bytes_of(s.folder / r.file)));
    const ending end = s.run(r.command(s.made), without_pictures);
    const std::string what = std::string(r.file) + ", " + damage;
    s.expect_message(end, what);
    if (end.status != 0 || end.error.find("warning") != std::string::npos)
        return;
    s.expect(r.outcome(end, s.folder) == right, what + ": another result without a word");
    s.expect(!must_report, what + ": not noticed, though without effect here");
}

ending decode(scene& s, const std::string& name, const std::string& bytes) {
    if (name.ends_with(".stream")) {
        words command{s.made.where().stream.string(), (s.made / "stream.net").string()};
        if (name == "own.stream")
            command.emplace_back("own");
        conditions under;
        under.input = bytes;
        write_bytes(s.folder / name, bytes); // to repeat it
        return s.run(command, under);
    }
    write_bytes(s.folder / name, bytes);
    return s.run({s.made.where().decode.string(), "--csv", name});
}

/// Without what differs from run to run: the microseconds after a stream's last tab.
std::string without_times(const std::string& from) {
    std::string text = from;
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; ++at)
        if (const std::size_t tab = text.rfind('\t', at);
            tab != std::string::npos && text.find('\n', tab) == at) {
            text.erase(tab, at - tab);
            at = tab;
        }
    return text;
}

/// If damage `must_report`, output that differs in what is `compared` needs a message.
void decode_damaged(scene& s, const std::string& name, const std::string& bytes, bool must_report,
                    std::string (*compared)(const std::string&) = without_times) {
    const ending end = decode(s, name, bytes);
    s.expect_message(end, name);
    if (must_report && end.error.empty())
        s.expect(compared(end.out) == compared(decode(s, name, bytes_of(s.made / name)).out),
                 name + ": other frames without a word");
}

/// The rows of frames in CSV, without the lines of their numbers and times, which no sum covers.
std::string cells_of(const std::string& csv) {
    std::string cells;
    for (const std::string& line : lines_of(csv))
        if (!line.starts_with("frame"))
            cells += line + '\n';
    return cells;
}

/// Whether each frame of a text recording has the sum that it states: then damage cannot be noticed.
bool sums_hold(const std::string& text) {
    constexpr std::string_view sum_begins = "raw sum=,,";
    long stated = 0, found = 0;
    for (std::string& line : lines_of(text)) {
        std::transform(line.begin(), line.end(), line.begin(), // a bit makes a letter small
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        std::erase(line, '"'); // which spreadsheets write around cells
        if (line.starts_with("frame")) {
            const std::size_t sum = line.find(sum_begins);
            if (stated != found || sum == std::string::npos)
                return false;
            stated = std::strtol(line.c_str() + sum + sum_begins.size(), nullptr, 10), found = 0;
        } else if (!line.empty() && line[0] >= '0' && line[0] <= '9') {
            const char* cell = line.c_str();
            for (char* stop = nullptr;; cell = stop + 1) {
                found += std::strtol(cell, &stop, 10);
                if (*stop != ',')
                    break;
            }
        }
    }
    return stated == found;
}

/// For a text recording whose frames have sums: other cells need a message, unless every sum still holds.
void decode_summed(scene& s, const std::string& bytes) {
    decode_damaged(s, "sample.csv", bytes, !sums_hold(bytes), cells_of);
}

} // namespace

std::string damaged_by_bit(scene& s, std::string bytes) {
    const std::size_t bit = s.below(bytes.size() * 8);
    bytes[bit / 8] = static_cast<char>(static_cast<unsigned char>(bytes[bit / 8]) ^ 1U << bit % 8);
    return bytes;
}

void flip_bits(scene& s, std::size_t number) {
    const reading& r = readings[number % readings.size()];
    read_damaged(
        s, r, "a bit flipped", [&](const std::string& bytes) { return damaged_by_bit(s, bytes); }, r.summed);
}

void flip_bits_of_recordings(scene& s, std::size_t number) {
    const std::array<const char*, 4> names{"sample.csv", "own.stream", "sample.fsx", "sample.mp"};
    const std::string name = names[number % names.size()];
    const std::string right = bytes_of(s.made / name);
    std::string bytes = damaged_by_bit(s, right);
    if (name == "sample.csv")
        return decode_summed(s, bytes);
    // Packets have a sum. Binary recordings and maps have none, and are only to be taken or refused in good
    // order.
    std::size_t changed = 0;
    while (bytes[changed] == right[changed])
        ++changed;
    // Whoever joins a stream cannot know that a packet came before.
    decode_damaged(s, name, bytes, name == "own.stream" && changed >= 2);
}

void flip_two_bits_of_sums(scene& s, std::size_t) {
    decode_summed(s, damaged_by_bit(s, damaged_by_bit(s, bytes_of(s.made / "sample.csv"))));
}

void cut_files(scene& s, std::size_t number) {
    constexpr std::size_t recordings = 5, images = 1;
    std::size_t kind = number % (readings.size() + recordings + images);
    if (kind < readings.size()) {
        const reading& r = readings[kind];
        return read_damaged(
            s, r, "cut short",
            [&](const std::string& bytes) { return bytes.substr(0, s.below(bytes.size())); }, r.summed);
    }
    kind -= readings.size();
    if (kind < recordings) {
        const std::array<const char*, recordings> names{"sample.csv", "own.stream", "sample.fsx", "sample.mp",
                                                        "plain.stream"};
        std::string bytes = bytes_of(s.made / names[kind]);
        bytes.resize(s.below(bytes.size()));
        // A stream may end after any packet.
        const std::size_t packet = kind == 1 ? 1404 : kind == 4 ? 1400 : bytes.size() + 1;
        return decode_damaged(s, names[kind], bytes, bytes.size() % packet != 0);
    }
    s.bring("data");
    const fs::path image = s.folder / "data" / "right" / "image3.png";
    const std::string whole = bytes_of(image);
    const std::size_t size = s.below(whole.size());
    write_bytes(image, whole.substr(0, size));
    const ending end =
        s.run(s.made.train({"--epochs", epochs, "--output", "net"}, (s.folder / "data").string()),
              without_pictures);
    s.expect(end.status != 0 || end.error.find("warning") != std::string::npos ||
                 bytes_of(s.folder / "net") == bytes_of(s.made / "net"),
             "an image cut to " + std::to_string(size) + " bytes: other weights without a word");
}

} // namespace faults
