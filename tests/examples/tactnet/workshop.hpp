#pragma once

// The program `tactnet` from outside: files in, files and exit status out. Tests do not repeat the includes.

#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/runtime/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <decode_image.hpp>
#include <fcntl.h>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <spawn.h>
#include <sstream>
#include <string>
#include <string_view>
#include <support/files/data_folder.hpp>
#include <support/files/temporary_folder.hpp>
#include <support/run_program.hpp>
#include <sys/wait.h>
#include <thread>
#include <type_traits>
#include <unistd.h>
#include <utility>
#include <vector>

namespace support {

namespace fs = std::filesystem;

inline constexpr std::size_t rows = 7, columns = 13, images_per_class = 12;
inline constexpr const char* class_names[] = {"left", "middle, of all", "right"}; // the comma is for CSV

inline void says(const std::string& text, std::string_view part) {
    CAPTURE(part);
    CHECK_MESSAGE(text.find(part) != std::string::npos, text);
}

inline void says_not(const std::string& text, std::string_view part) {
    CAPTURE(part);
    CHECK_MESSAGE(text.find(part) == std::string::npos, text);
}

inline std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

using outcome = program_result;

/// The exit status of a process, or 1000 and the signal that ended it.
inline int status_of(int status) {
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

/// Arguments of the program, of a line or a list; DATA stands for the workshop's folder of images, IMAGE for
/// one of the first class.
struct words : std::vector<std::string> {
    using std::vector<std::string>::vector;
    words(const std::vector<std::string>& list) : std::vector<std::string>(list) {}
    words(const std::string& text) : words(text.c_str()) {}
    words(const char* line) {
        std::istringstream stream(line);
        for (std::string word; stream >> word;)
            push_back(word);
    }
    words& operator+=(const words& more) {
        insert(end(), more.begin(), more.end());
        return *this;
    }
    friend words operator+(words first, const words& more) { return first += more; }
};

/// The program with its own folder to work in: <folder>/work.
class workshop {
public:
    workshop() {
        fs::create_directory(work());
        tactnet::random_stream random(1, tactnet::random_purposes::order);
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < images_per_class; ++i) {
                std::vector<std::uint8_t> pixels(rows * columns);
                for (std::size_t e = 0; e < pixels.size(); ++e)
                    pixels[e] =
                        static_cast<std::uint8_t>(random.below(40) + (e % columns / 5 == c ? 150 : 0));
                fs::create_directories(data() / class_names[c]);
                write_png(image(c, i), rows, columns, pixels);
            }
    }

    fs::path data() const { return folder_ / "data"; }
    fs::path image(std::size_t label = 0, std::size_t index = 0) const {
        return data() / class_names[label] / ("image" + std::to_string(index) + ".png");
    }
    /// The first of each class alone: some methods take long for an image.
    void keep_images(std::size_t count) const {
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = count; i < images_per_class; ++i)
                fs::remove(image(c, i));
    }
    fs::path work() const { return folder_ / "work"; }
    fs::path operator/(const fs::path& name) const { return work() / name; }
    std::string text(const fs::path& name) const { return text_of(work() / name); }
    std::vector<std::string> lines(const fs::path& name) const { return lines_of(text(name)); }

    pid_t start(const words& arguments) const {
        words texts = words{TACTNET_PROGRAM} + arguments;
        std::replace(texts.begin(), texts.end(), std::string("DATA"), data().string());
        std::replace(texts.begin(), texts.end(), std::string("IMAGE"), image().string());
        std::vector<char*> pointers;
        for (std::string& text : texts)
            pointers.push_back(text.data());
        pointers.push_back(nullptr);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addchdir_np(&actions, work().c_str());
        const std::string out = (folder_ / "out").string();
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                         0600);
        int ends[2];
        REQUIRE(pipe2(ends, O_CLOEXEC) == 0);
        posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
        pid_t child = -1;
        REQUIRE(posix_spawn(&child, TACTNET_PROGRAM, &actions, nullptr, pointers.data(), environ) == 0);
        posix_spawn_file_actions_destroy(&actions);
        close(ends[1]);
        errors_[child] = {ends[0], {}};
        return child;
    }
    /// Until the program reports this, or ends.
    void wait_for(pid_t child, const std::string& report) const {
        auto& [end, error] = errors_.at(child);
        char bytes[4096];
        for (ssize_t got = 1; got > 0 && error.find(report) == std::string::npos;) {
            got = read(end, bytes, sizeof(bytes));
            if (got > 0)
                error.append(bytes, static_cast<std::size_t>(got));
        }
    }
    void wait_for_first_epoch(pid_t child) const { wait_for(child, "epoch 1 of"); }
    void wait_for_file(const char* name) const {
        for (int i = 0; i < 60'000 && !fs::exists(work() / name); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    outcome wait(pid_t child) const {
        wait_for(child, std::string(1, '\0')); // which no report contains
        int status = 0;
        REQUIRE(waitpid(child, &status, 0) == child);
        const auto [end, error] = std::move(errors_.extract(child).mapped());
        close(end);
        return {status_of(status), text_of(folder_ / "out"), error};
    }
    outcome stop(pid_t child, int signal) const {
        kill(child, signal);
        return wait(child);
    }
    outcome run(const words& arguments) const { return wait(start(arguments)); }

    /// Exit status 0.
    outcome succeeds(const words& arguments) const {
        outcome result = run(arguments);
        REQUIRE_MESSAGE(result.status == 0, result.error);
        return result;
    }

    /// A training of a second or less, with more arguments.
    outcome train(const words& more) const { return run(train_arguments(more)); }
    outcome trains(const words& more) const { return succeeds(train_arguments(more)); }
    words train_arguments(const words& more) const {
        words all("train");
        for (const words& usual : {words("--data DATA"), words("--method tactnet4"), words("--rows 7"),
                                   words("--columns 13"), words("--threads 1"), words("--seed 5")})
            if (std::find(more.begin(), more.end(), usual.front()) == more.end())
                all += usual;
        return all + more;
    }

    /// Exit status 2, the sentence, and nothing written. Returns what was reported.
    std::string refuses(const words& arguments, const std::string& sentence) const {
        CAPTURE(sentence);
        const auto before = everything();
        const outcome result = run(arguments);
        CHECK(result.status == 2);
        CHECK(result.out.empty());
        CHECK_MESSAGE(result.error.find(sentence) != std::string::npos, result.error);
        CHECK(everything() == before);
        return result.error;
    }

    /// The same of each of some arguments with their sentences.
    void refuses_each(const std::vector<std::pair<words, std::string>>& list) const {
        for (const auto& [arguments, sentence] : list)
            refuses(arguments, sentence);
    }

    std::set<std::string> everything() const {
        std::set<std::string> names;
        for (const auto& entry : fs::recursive_directory_iterator(work()))
            names.insert(entry.path().string());
        return names;
    }

private:
    support::temporary_folder folder_;
    /// Of running programs: the end of a pipe, and what came through it.
    mutable std::map<pid_t, std::pair<int, std::string>> errors_;
};

/// What a file holds, but for some of its tensors.
inline tactnet::safetensors_writer copy_of(
    const tactnet::safetensors& file,
    const std::function<bool(const std::string&)>& is_left_out = [](auto&) { return false; }) {
    tactnet::safetensors_writer writer;
    writer.metadata = file.metadata();
    for (const auto& [name, entry] : file.tensors())
        if (!is_left_out(name))
            writer.add(name, entry.type, entry.extents, file.bytes(name));
    return writer;
}

/// The weight file with one tensor changed.
template <class Number = float>
void rewrite(const fs::path& from, const fs::path& to, const std::string& tensor,
             const std::type_identity_t<std::function<void(std::vector<Number>&)>>& change) {
    const auto file = tactnet::safetensors::read(from);
    tactnet::safetensors_writer writer =
        copy_of(file, [&](const std::string& name) { return name == tensor; });
    auto values = file.values<Number>(tensor);
    change(values);
    auto extents = file.at(tensor).extents;
    if (extents.size() == 1)
        extents[0] = values.size();
    writer.add(tensor, std::move(extents), std::span<const Number>(values));
    writer.write(to);
}

/// A safetensors file with one of its metadata changed.
inline void rewrite_metadata(const fs::path& from, const fs::path& to, const std::string& key,
                             const std::string& value) {
    tactnet::safetensors_writer writer = copy_of(tactnet::safetensors::read(from));
    writer.metadata[key] = value;
    writer.write(to);
}

/// A safetensors file as a version without checksums wrote it; of the same size.
inline std::string without_checksum(std::string bytes) {
    const std::size_t at = bytes.find("\"tactnet.checksum\":\"");
    REQUIRE(at != std::string::npos);
    const std::size_t length = bytes.find('"', at + 20) + 1 - at;
    const std::string other = "\"before\":\"";
    return bytes.replace(at, length, other + std::string(length - other.size() - 1, '-') + "\"");
}

} // namespace support
