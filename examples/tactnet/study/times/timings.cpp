#include "study/times/timings.hpp"

#include "methods/description.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <fstream>
#include <processor.hpp>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <utility>

namespace {

std::string machine_name() {
    std::array<char, 256> name{};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

tactnet::file_metadata key_of(const method& what, std::size_t bits) {
    tactnet::file_metadata key{{"method", what.name},
                               {"rows", fmt::to_string(what.rows)},
                               {"columns", fmt::to_string(what.columns)},
                               {"processor", processor_name()},
                               {"machine", machine_name()},
                               {"compiler", compiler_name()}};
    key.merge(describe_program());
    key.merge(what.parts());
    if (bits == 8) // of which timings made before say nothing, and mean single precision
        key["bits"] = "8";
    return key;
}

} // namespace

timing_list::timing_list(const std::filesystem::path& path) : file_(path) {
    read_on();
}

void timing_list::read_on() {
    file_.read_on("a timing of tactnet study", [&](const std::string& text) {
        const auto line = nlohmann::json::parse(text);
        const auto positive = [&](const char* name) {
            const double value = line.at(name);
            if (!(value > 0))
                throw std::runtime_error(fmt::format("expected {} above 0, found {}", name, value));
            return value;
        };
        all_[line.at("settings").get<tactnet::file_metadata>()] = {positive("median"), positive("p99"),
                                                                   positive("in_batch"), positive("jitter")};
    });
}

const frame_latency* timing_list::find(const method& what, std::size_t bits) const {
    const auto found = all_.find(key_of(what, bits));
    return found == all_.end() ? nullptr : &found->second;
}

std::map<std::string, frame_latency> timing_list::by_instruction_set(const method& what,
                                                                     std::size_t bits) const {
    constexpr const char* name = "instruction_set";
    std::map<std::string, frame_latency> found;
    const tactnet::file_metadata wanted = key_of(what, bits);
    for (const auto& [settings, latency] : all_) {
        tactnet::file_metadata here = settings;
        const auto set = here.find(name);
        if (set == here.end())
            continue;
        const std::string kept = std::exchange(set->second, wanted.at(name));
        if (here == wanted)
            found[kept] = latency;
    }
    return found;
}

void timing_list::add(const method& what, std::size_t bits, const frame_latency& found) {
    const tactnet::file_metadata key = key_of(what, bits);
    file_.add(nlohmann::ordered_json{{"settings", key},
                                     {"median", found.median},
                                     {"p99", found.p99},
                                     {"in_batch", found.in_batch},
                                     {"jitter", found.jitter}}
                  .dump());
    all_[key] = found;
}

std::string compiler_name() {
#if defined(__clang__)
    return fmt::format("Clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#elif defined(__GNUC__)
    return fmt::format("GCC {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#else
    return "unknown";
#endif
}
