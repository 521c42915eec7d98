#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors_writer.hpp>
#include <tactnet/io/text.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

// A training that was stopped, so that it can go on as if it had not been. A checkpoint remembers the
// settings of its training (network, recipe, seed, data, …) as text: going on with others would give a
// network that no settings describe, so that is an error which says what differs.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Writes all that `trainer` needs to go on, all or nothing. `settings` is what must be the same then. The
/// trainer is not changed. Throws file_error.
template <class Trainer>
void save_checkpoint(const std::filesystem::path& path, Trainer& trainer, const file_metadata& settings) {
    safetensors_writer writer;
    for (const auto& [key, value] : settings)
        writer.metadata["setting." + key] = value;
    writer.metadata["format"] = "tactnet checkpoint";
    writer.metadata["version"] = "1";
    trainer.for_each_state([&](std::string_view name, auto values) {
        using number = typename decltype(values)::value_type;
        writer.add(std::string(name), {values.size()}, std::span<const number>(values));
    });
    const std::vector<double> progress = trainer.progress();
    writer.add("progress", {progress.size()}, std::span<const double>(progress));
    writer.write(path);
}

/// Puts a trainer that was made with the same settings where the checkpoint left off. Throws file_error when
/// the file is no checkpoint, is damaged, has other settings, or is where such a training cannot be; the
/// trainer is then as it was.
template <class Trainer>
void load_checkpoint(const std::filesystem::path& path, Trainer& trainer, const file_metadata& settings) {
    const safetensors file = safetensors::read(path);
    const auto stored = [&](const std::string& key) -> const std::string* {
        const auto found = file.metadata().find(key);
        return found == file.metadata().end() ? nullptr : &found->second;
    };
    const std::string* format = stored("format");
    if (format == nullptr || *format != "tactnet checkpoint")
        throw file_error(file.file(), "metadata 'format'", "'tactnet checkpoint'",
                         format == nullptr ? "none" : in_quotes(*format));
    if (const std::string* version = stored("version"); version == nullptr || *version != "1")
        throw file_error(file.file(), "metadata 'version'", "version 1",
                         version == nullptr ? "none" : in_quotes(*version));
    for (const auto& [key, value] : settings) {
        const std::string* found = stored("setting." + key);
        if (found == nullptr || *found != value)
            throw file_error(file.file(), "setting '" + key + "' of the stopped training", in_quotes(value),
                             found == nullptr ? "none" : in_quotes(*found));
    }

    // All is read and checked before any of it is used.
    std::vector<std::vector<double>> states;
    trainer.for_each_state([&](std::string_view name, auto to) {
        file.require_extents(name, std::vector{to.size()});
        states.push_back(file.values<double>(name));
        for (std::size_t i = 0; i < states.back().size(); ++i)
            if (!std::isfinite(states.back()[i]))
                throw file_error(file.file(), detail::tensor_place(name) + ", element " + std::to_string(i),
                                 "a finite number", std::to_string(states.back()[i]));
    });
    const std::vector<double> progress = file.values<double>("progress");
    try {
        trainer.restore(progress);
    } catch (const std::invalid_argument& error) {
        throw file_error(file.file(), detail::tensor_place("progress"), "the numbers of this training",
                         "'" + std::string(error.what()) + "'");
    }
    std::size_t index = 0;
    trainer.for_each_state([&](std::string_view, auto to) {
        using number = typename decltype(to)::value_type;
        const std::vector<double>& from = states[index++];
        std::transform(from.begin(), from.end(), to.begin(), [](double v) { return static_cast<number>(v); });
    });
}

} // namespace TACTNET_ARCH
} // namespace tactnet
