// Files that are whole and well-formed, and say what nobody would mean; and settings of another machine.

#include "groups.hpp"

#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>
#include <tactnet/io/safetensors/writer.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <span>

namespace faults {
namespace {

using namespace std::string_literals;

/// Adds to a weight file; its checksum is right.
void rewrite(const fs::path& file, const std::function<void(tactnet::safetensors_writer&)>& add) {
    const auto old = tactnet::safetensors::read(file);
    tactnet::safetensors_writer writer;
    writer.metadata = old.metadata();
    for (const auto& [name, entry] : old.tensors())
        writer.add(name, entry.type, entry.extents, old.bytes(name));
    add(writer);
    fs::remove(file);
    writer.write(file);
}

/// Whoever reads weights; each must refuse them in a short sentence, soon.
void must_be_refused(scene& s, const std::string& what, const std::string& sentence) {
    const std::vector<words> readers{
        s.made.classify("net"), s.made.tactnet({"export", "--weights", "net", "--output", "out"}),
        s.made.train({"--epochs", "2", "--start", "net", "--output", "out"}),
        s.made.tactnet({"evaluate", "--data", (s.made / "data").string(), "--weights", "net"})};
    expect_refusal(s, s.one_of(readers), sentence, what);
}

void surplus_tensors(scene& s) {
    s.bring("net");
    const std::size_t count = 1 + s.below(40'000), length = 1 + s.below(400), extents = s.below(2000);
    rewrite(s.folder / "net", [&](tactnet::safetensors_writer& to) {
        for (std::size_t i = 0; i < count; ++i) {
            std::vector<std::size_t> shape(i == 0 ? extents : 0, std::size_t(-1)); // of nothing
            shape.insert(shape.begin(), 0);
            to.add(std::string(length, 'x') + std::to_string(i), tactnet::element_type::float32, shape,
                   std::span<const std::byte>());
        }
    });
    must_be_refused(s, std::to_string(count) + " surplus tensors", " of another network");
}

void long_texts(scene& s) {
    s.bring("net");
    const std::array keys{"network"s, "classes"s, "input"s, "temperature"s, "epsilon"s, "rows"s, "version"s};
    const std::string key = s.one_of(keys),
                      text(201 + s.below(1'000'000), s.one_of(std::array{'x', '9', '[', '"', '\x1B'}));
    rewrite(s.folder / "net", [&](tactnet::safetensors_writer& to) { to.metadata[key] = text; });
    must_be_refused(s, key + " of " + std::to_string(text.size()) + " bytes", "metadata '" + key + "'");
}

void stored_temperature(scene& s) {
    s.bring("net");
    const std::array refused{"1e-320"s, "0"s,    "-1"s, "nan"s, "inf"s,   "1e300"s,
                             "0.0009"s, "1001"s, "1 "s, ""s,    "0x1p0"s, "1e-4000"s};
    const std::array taken{"0.001"s, "0.5"s, "1"s, "20"s, "1000"s};
    const bool good = s.below(3) == 0;
    const std::string value = good ? s.one_of(taken) : s.one_of(refused);
    rewrite(s.folder / "net", [&](tactnet::safetensors_writer& to) { to.metadata["temperature"] = value; });
    if (!good)
        return must_be_refused(s, "temperature " + value, "metadata 'temperature': expected a ");
    const ending end = s.run(s.made.classify("net"), without_pictures);
    s.expect(end.done(), "temperature " + value + ": " + end.text());
    for (const std::string& line : lines_of(end.out)) {
        const double probability = std::strtod(line.c_str() + line.rfind(',') + 1, nullptr);
        s.expect(probability >= 1.0 / 3 && probability <= 1, "temperature " + value + ": " + line);
    }
}

/// Names of classes that mean something to a spreadsheet or gnuplot.
void names_of_classes(scene& s) {
    s.bring("data");
    const std::array names{"50 %"s, "%s"s,  "#x"s,    "=1+1"s, "+1"s, "-1"s,
                           "@x"s,   "a'b"s, "\"q\""s, "a\\n"s, "ä %"s};
    const std::string name = s.one_of(names);
    fs::rename(s.folder / "data" / "left", s.folder / "data" / name);
    const ending end = s.run(s.made.train({"--epochs", "2", "--output", "out"}, "data"));
    s.expect(end.done(), "a class '" + name + "': " + end.text());
    static const bool there_is_gnuplot = fs::exists(s.made / "net.confusion.png");
    s.expect(!there_is_gnuplot || fs::exists(s.folder / "out.confusion.png"),
             "a class '" + name + "': no picture (" + end.error + ")");
    for (const std::string& line : lines_of(bytes_of(s.folder / "out.confusion.csv")))
        s.expect(line.empty() || std::string("=+-@").find(line[0]) == std::string::npos,
                 "a spreadsheet runs '" + line + "'");
}

void list_of_names(scene& s) {
    s.bring("net");
    const std::string mark = s.below(2) == 0 ? "\xEF\xBB\xBF" : "",
                      end_of_line = s.below(2) == 0 ? "\n" : "\r\n";
    const bool twice = s.below(2) == 0;
    write_bytes(s.folder / "names",
                mark + "one" + end_of_line + "two" + end_of_line + (twice ? "one" : "three") + end_of_line);
    const ending end =
        s.run(s.made.tactnet({"export", "--weights", "net", "--output", "out", "--classes", "names"}),
              without_pictures);
    s.expect(twice ? end.status == 2 && end.error.find("'one' twice") != std::string::npos : end.done(),
             "a list of names: " + end.text());
    s.expect(twice || bytes_of(s.folder / "out").find("    \"one\",\n    \"two\",\n    \"three\",\n") !=
                          std::string::npos,
             "other names than in the list");
}

void missing_folders(scene& s) {
    const std::size_t depth = s.below(4);
    std::string folder;
    for (std::size_t i = 0; i < depth; ++i)
        folder += std::string(1 + s.below(20), 'a') + "/";
    const std::array commands{
        s.made.train({"--epochs", "1", "--output", folder + "out"}),
        s.made.tactnet({"export", "--weights", (s.made / "net").string(), "--output", folder + "out"}),
        s.made.evaluate({"--results", folder + "r"})};
    const std::size_t which = s.below(commands.size());
    const ending end = s.run(commands[which], without_pictures);
    s.expect(end.done(), "missing folders: " + end.text());
    const std::size_t made = depth + (which == 2 ? 1 : 0);
    s.expect((end.error.find("neither this folder nor the one above it is there") != std::string::npos) ==
                 (made > 1),
             std::to_string(made) + " folders were made: " + end.error);
}

/// Results of another machine, version or setting.
void foreign_results(scene& s) {
    s.bring("results");
    const fs::path file = s.folder / "results" / "evaluation.jsonl";
    const std::array keys{"\"instruction_set\":\""s, "\"library\":\""s, "\"rate\":\""s};
    const std::size_t kind = s.below(keys.size());
    std::vector<std::string> lines = lines_of(bytes_of(file));
    for (std::string& line : lines) {
        line = line.substr(0, line.rfind(",\"checksum\":")) + "}";
        const std::size_t at = line.find(keys[kind]) + keys[kind].size();
        line.replace(at, line.find('"', at) - at, "7");
        line = tactnet::with_checksum(line);
    }
    write_bytes(file, text_of(lines));
    const bool take = kind < 2 && s.below(2) == 0;
    words command = s.made.evaluate({"--results", "results"});
    if (take)
        command.emplace_back("--elsewhere");
    const ending end = s.run(command, without_pictures);
    s.expect(end.done() &&
                 end.error.find(take       ? " trainings are by tactnet "
                                : kind < 2 ? " of these lie there, made by another version"
                                           : " others lie there, of other rate") != std::string::npos,
             "results with another " + keys[kind] + ": " + end.text());
    s.expect(!take || end.error.find("\n0 trainings to do") != std::string::npos,
             "results of another program were not taken: " + end.text());
}

} // namespace

void expect_refusal(scene& s, const words& command, const std::string& part, const std::string& what) {
    conditions under = without_pictures;
    under.patience = std::chrono::seconds(20);
    const ending end = s.run(command, under);
    s.expect(end.status != 0 && end.error.find(part) != std::string::npos,
             what + ": expected '" + part + "', found " + end.text());
    s.expect(end.error.size() < 1500, what + ": a message of " + std::to_string(end.error.size()) + " bytes");
}

void say_hostile_things(scene& s, std::size_t number) {
    constexpr std::array kinds{surplus_tensors, stored_temperature, names_of_classes, list_of_names,
                               missing_folders, foreign_results,    long_texts};
    kinds[number % kinds.size()](s);
}

} // namespace faults
