#include "scene.hpp"

#include <algorithm>
#include <csignal>
#include <decode_image.hpp>
#include <stdexcept>

namespace faults {
namespace {

void make_images(const fs::path& folder) {
    constexpr std::size_t rows = 7, columns = 13;
    std::mt19937_64 random(1);
    const char* const names[] = {"left", "middle, of all", "right"};
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < 12; ++i) {
            std::vector<std::uint8_t> pixels(rows * columns);
            for (std::size_t e = 0; e < pixels.size(); ++e)
                pixels[e] = static_cast<std::uint8_t>(random() % 40 + (e % columns / 5 == c ? 150 : 0));
            fs::create_directories(folder / names[c]);
            write_png(folder / names[c] / ("image" + std::to_string(i) + ".png"), rows, columns, pixels);
        }
}

} // namespace

materials::materials(programs which) : programs_(std::move(which)) {
    fs::create_directories(folder());
    fs::permissions(folder_.path(), fs::perms::all);
    make_images(folder() / "data");
    const auto make = [&](const words& command, const conditions& under = {}) {
        const ending end = run(command, folder(), under);
        if (!end.done() && under.signal == 0)
            throw std::runtime_error("undisturbed: " + shell_line(command, folder()) + ": " + end.text());
        return end;
    };
    make(train({"--epochs", epochs, "--output", "net"}));
    make(train({"--epochs", epochs, "--output", "untested", "--self-test", "0"}));
    for (const char* method : {"svm-rbf", "svm-linear"})
        make(tactnet({"train", "--data", "data", "--method", method, "--rows", "7", "--columns", "13",
                      "--seed", "5", "--output", method}));
    make(evaluate({"--results", "results"}));
    make(study({"--results", "study"}), without_pictures);
    make(simulate("simulated"));
    make(tactnet({"export", "--weights", "net", "--output", "net.hpp"}));
    // Any epoch's checkpoint will do: all go on to the same weights.
    conditions stops;
    stops.signal = SIGINT;
    for (stops.after = std::chrono::milliseconds(5); !fs::exists(folder() / "stopped.checkpoint");
         stops.after += std::chrono::milliseconds(5)) {
        if (stops.after > std::chrono::seconds(1))
            throw std::runtime_error("a stopped training leaves no checkpoint");
        fs::remove(folder() / "stopped");
        make(train({"--epochs", epochs, "--output", "stopped"}), stops);
    }
    for (const auto& [name, bytes] : recordings())
        write_bytes(folder() / name, bytes);
}

fs::path materials::new_folder() const {
    const fs::path work = folder_.path() / "work";
    // Permissions that a case took away must not keep its folder.
    fs::remove_all(work);
    fs::create_directory(work);
    fs::permissions(work, fs::perms::all);
    return work;
}

words materials::tactnet(words arguments, const words& more) const {
    arguments.insert(arguments.begin(), programs_.tactnet.string());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

words materials::train(const words& more, const std::string& data) const {
    return tactnet({"train", "--data", data.empty() ? (folder() / "data").string() : data, "--method",
                    "tactnet4", "--rows", "7", "--columns", "13", "--seed", "5"},
                   more);
}

words materials::evaluate(const words& more) const {
    return tactnet({"evaluate", "--data", (folder() / "data").string(), "--method", "tactnet4", "--rows", "7",
                    "--columns", "13", "--epochs", "4", "--splits", "2", "--jobs", "2"},
                   more);
}

words materials::study(const words& more) const {
    return tactnet({"study", "--data", (folder() / "data").string(), "--methods", "tactnet4", "--sizes",
                    "7x13", "--split", "random", "--splits", "1", "--jobs", "2"},
                   more);
}

words materials::simulate(const std::string& out) const {
    return tactnet({"simulate", "--out", out, "--per-class", "1", "--threads", "2"});
}

words materials::classify(const std::string& weights) const {
    words all = tactnet({"classify", "--weights", weights});
    for (const char* name : {"left", "middle, of all", "right"})
        for (const char* image : {"image0.png", "image5.png"})
            all.push_back((folder() / "data" / name / image).string());
    return all;
}

scene::scene(const materials& of, std::uint64_t seed, const std::string& group, std::size_t number)
    : made(of), folder(of.new_folder()) {
    std::vector<std::uint32_t> parts{static_cast<std::uint32_t>(seed),
                                     static_cast<std::uint32_t>(seed >> 32U),
                                     static_cast<std::uint32_t>(number)};
    for (const char c : group)
        parts.push_back(static_cast<unsigned char>(c));
    std::seed_seq mixed(parts.begin(), parts.end());
    engine_.seed(mixed);
}

void scene::bring(const std::string& name) const {
    fs::copy(made / name, folder / name, fs::copy_options::recursive);
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        fs::permissions(entry.path(), fs::perms::all);
}

ending scene::run(const words& command, const conditions& under) {
    ending end = run_to_any_end(command, under);
    expect_order(end);
    return end;
}

ending scene::run_to_any_end(const words& command, const conditions& under) {
    command_ += (command_.empty() ? "" : "\n      then ") + shell_line(command, folder, under);
    return faults::run(command, folder, under);
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t at = 0, end = 0; at < text.size(); at = end + 1) {
        end = std::min(text.find('\n', at), text.size());
        lines.push_back(text.substr(at, end - at));
    }
    return lines;
}

std::string text_of(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines)
        text += line + '\n';
    return text;
}

std::vector<std::string> results_in(const fs::path& list) {
    std::vector<std::string> results;
    std::string whole = bytes_of(list);
    whole.erase(whole.rfind('\n') + 1); // a last line without an end is half-written
    for (const std::string& line : lines_of(whole)) {
        const auto part = [&](const char* from, const char* to) {
            const std::size_t begin = line.find(from);
            return begin == std::string::npos ? "" : line.substr(begin, line.find(to, begin) - begin);
        };
        results.push_back(part("\"settings\"", "\"seconds\"") + part("\"classes\"", "]"));
    }
    std::sort(results.begin(), results.end());
    return results;
}

std::map<std::string, std::string> files_in(const fs::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            files[entry.path().lexically_relative(folder).string()] = bytes_of(entry.path());
    return files;
}

std::string litter_in(const fs::path& folder) {
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.path().filename().string().starts_with(".tactnet-"))
            return entry.path().lexically_relative(folder).string();
    return "";
}

} // namespace faults
