// Values that someone has written into a file where another stood.

#include "groups.hpp"

#include <algorithm>
#include <array>

namespace faults {
namespace {

using namespace std::string_literals;

/// Characters that would be commands to a terminal.
bool has_control_characters(const ending& end) {
    const auto controls = [](char c) {
        const auto byte = static_cast<unsigned char>(c);
        return (byte < 0x20 && c != '\n' && c != '\r' && c != '\t') || byte == 0x7F;
    };
    return std::any_of(end.out.begin(), end.out.end(), controls) ||
           std::any_of(end.error.begin(), end.error.end(), controls);
}

/// A measure of a recording that is no number of its kind: exit status 1 with a message, or a warning.
void replace_measure(scene& s) {
    struct measure {
        const char *file, *key, *end; ///< the value stands between the two
    };
    constexpr std::array measures{
        measure{"sample.csv", "ROWS ", "\r\n"},
        measure{"sample.csv", "COLS ", "\r\n"},
        measure{"sample.csv", "SECONDS_PER_FRAME ", "\r\n"},
        measure{"sample.csv", "START_FRAME ", "\r\n"},
        measure{"sample.csv", "END_FRAME ", "\r\n"},
        measure{"sample.csv", "Raw Sum=,,", "\r\n"},
        measure{"sample.fsx", "ROWS ", "\n"},
        measure{"sample.fsx", "COLS ", "\n"},
        measure{"sample.fsx", "NOISE_THRESHOLD ", "\n"},
        measure{"sample.fsx", "SECONDS_PER_FRAME ", "\n"},
        measure{"sample.fsx", "START_FRAME ", "\n"},
        measure{"sample.fsx", "END_FRAME ", "\n"},
    };
    const std::array values{
        "nan"s, "inf"s, "-310"s, "310x"s,     "u25"s, "1e999"s,   "-0.5"s, "0x12"s,
        "1 2"s, "٣"s,   "--5"s,  "5\x1b[2J"s, "5\0"s, "\u202e5"s, "1,5"s,  std::string(300, '9')};
    const measure& of = s.one_of(measures);
    const std::string value = s.one_of(values);
    std::string bytes = bytes_of(s.made / of.file);
    std::vector<std::size_t> places;
    for (std::size_t at = 0; (at = bytes.find(of.key, at)) != std::string::npos; ++at)
        places.push_back(at + std::string(of.key).size());
    const std::size_t at = s.one_of(places);
    bytes.replace(at, bytes.find(of.end, at) - at, value);
    write_bytes(s.folder / of.file, bytes);
    const ending end = s.run({s.made.where().decode.string(), "--csv", of.file});
    const std::string what = of.key + ("'" + value + "'") + " in " + of.file;
    s.expect(!end.error.empty(), what + ": no message");
    s.expect(!has_control_characters(end), what + ": a terminal gets control characters");
}

/// A line of results with another checksum than its own, or none.
void replace_checksum(scene& s) {
    struct reading {
        const char *folder, *file;
        words command;
    };
    const std::vector<reading> readings{
        {"results", "results/evaluation.jsonl", s.made.evaluate({"--results", "results"})},
        {"study", "study/evaluation.jsonl", s.made.study({"--results", "study", "--report-only"})},
        {"study", "study/timings.jsonl", s.made.study({"--results", "study", "--report-only"})},
        {"study", "study/study.jsonl", s.made.tactnet({"recommend", "--results", "study"})},
    };
    const reading& of = s.one_of(readings);
    s.bring(of.folder);
    std::vector<std::string> lines = lines_of(bytes_of(s.folder / of.file));
    std::string& line = lines[s.below(lines.size())];
    const std::size_t at = line.rfind(",\"checksum\":");
    s.expect(at != std::string::npos, std::string(of.file) + ": a line without a checksum");
    const std::array endings{"}"s,
                             ",\"checksum\":null}"s,
                             ",\"checksum\":\"\"}"s,
                             ",\"checksum\":0}"s,
                             ",\"checksum\":[]}"s,
                             ",\"checksum\":\"tactnet-xxh64:0000000000000000\"}"s,
                             ",\"checksum\":\"tactnet-xxh64:\"}"s,
                             ",\"Checksum\":\"tactnet-xxh64:0000000000000000\"}"s};
    const std::string ending_of_line = s.one_of(endings);
    line.replace(at, std::string::npos, ending_of_line);
    write_bytes(s.folder / of.file, text_of(lines));
    const ending end = s.run(of.command, without_pictures);
    s.expect(end.error.find(fs::path(of.file).filename().string()) != std::string::npos,
             std::string(of.file) + " with " + ending_of_line + ": no message that names it");
}

/// Classes and images whose names would be commands to a terminal, or more lines than one.
void name_with_controls(scene& s) {
    const std::array controls{"\x1b[2J"s, "\n"s,       "\t"s,     "\r"s,    "\x7f"s,
                              "\x01"s,    "\xc2\x9b"s, "\u202e"s, "\u2066"s};
    const std::string name = "a" + s.one_of(controls) + "b";
    const auto raw = [&](const ending& end) {
        return end.out.find(name) != std::string::npos || end.error.find(name) != std::string::npos ||
               has_control_characters(end);
    };
    if (s.below(2) == 0) { // an image: classified like any other, on a line of its own
        s.bring("net");
        fs::copy_file(s.made.image(), s.folder / (name + ".png"));
        const ending end =
            s.run(s.made.tactnet({"classify", "--weights", "net", name + ".png"}), without_pictures);
        s.expect(end.done() && lines_of(end.out).size() == 1,
                 "an image was not classified in one line: " + end.text());
        return s.expect(!raw(end), "the name of an image reaches the terminal as it is");
    }
    s.bring("data");
    fs::rename(s.folder / "data" / "left", s.folder / "data" / name);
    const ending end = s.run(s.made.train({"--epochs", "2", "--output", "out"}, "data"), without_pictures);
    s.expect(!end.done() && !end.error.empty() && !fs::exists(s.folder / "out"),
             "a class with a control character in its name was taken");
    s.expect(!raw(end), "the name of a class reaches the terminal as it is");
}

/// Classes in a weight file, as they stand in JSON: the program writes the name of what it recognises.
void name_classes_with_controls(scene& s) {
    const std::array refused{"a\\u001bb"s, "a\\nb"s,     "a\\tb"s,    "a\\u0000b"s,
                             "a\\u007fb"s, "a\\u009bb"s, "a\\u202eb"s};
    const std::array taken{"a b"s, "ä"s, "a\\\"b"s, "%s%n"s, "\\u65e5"s};
    const bool good = s.below(4) == 0;
    const std::string name = good ? s.one_of(taken) : s.one_of(refused);
    write_bytes(s.folder / "named.net", network(name));
    conditions under;
    under.input = bytes_of(s.made / "plain.stream");
    const ending end = s.run({s.made.where().stream.string(), "named.net"}, under);
    if (good)
        return s.expect(end.done(), "a class '" + name + "' was refused: " + end.text());
    s.expect(!end.done() && end.error.find("named.net") != std::string::npos,
             "a class '" + name + "' was taken: " + end.text());
    s.expect(!has_control_characters(end), "a class reaches the terminal as it is");
}

} // namespace

void replace_values(scene& s, std::size_t number) {
    constexpr std::array kinds{replace_measure, replace_checksum, name_with_controls,
                               name_classes_with_controls};
    kinds[number % kinds.size()](s);
}

} // namespace faults
