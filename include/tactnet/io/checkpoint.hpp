#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/checksum.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/io/safetensors/index.hpp>
#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/text/quoting.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

// A training that was stopped, so that it can go on as if it had not been. A checkpoint remembers the
// settings of its training (network, recipe, seed, data, …) as text: going on with others would give a
// network that no settings describe, so that is an error which says what differs.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// One array of a training, under its name, for a trainer whose type is known elsewhere. A view.
struct state_array {
    std::string name;
    std::variant<std::span<float>, std::span<double>> values;
};

/// The arrays of a trainer, which must outlive them.
template <class Trainer>
[[nodiscard]] std::vector<state_array> state_arrays(Trainer& trainer) {
    std::vector<state_array> arrays;
    trainer.for_each_state([&](std::string_view name, auto values) {
        arrays.push_back({std::string(name), values});
    });
    return arrays;
}

/// Writes arrays and the numbers beside them, all or nothing. Throws file_error.
inline void save_checkpoint(const std::filesystem::path& path, std::span<const state_array> arrays,
                            std::span<const double> progress, const file_metadata& settings) {
    safetensors_writer writer;
    for (const auto& [key, value] : settings)
        writer.metadata["setting." + key] = value;
    writer.metadata["format"] = "tactnet checkpoint";
    writer.metadata["version"] = "1";
    for (const state_array& array : arrays)
        std::visit([&](auto values) { writer.add(array.name, {values.size()}, std::as_const(values)); },
                   array.values);
    writer.add("progress", {progress.size()}, progress);
    writer.write(path);
}

/// Writes all that `trainer` needs to go on, all or nothing. `settings` is what must be the same then. The
/// trainer is not changed. Throws file_error.
template <class Trainer>
void save_checkpoint(const std::filesystem::path& path, Trainer& trainer, const file_metadata& settings) {
    save_checkpoint(path, state_arrays(trainer), trainer.progress(), settings);
}

namespace detail {

/// Throws file_error unless the file is a checkpoint of a training with these settings.
inline void check_checkpoint(const safetensors_index& file, const file_metadata& settings) {
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
}

} // namespace detail

/// Throws file_error unless the file says that it is a checkpoint of a training with these settings. Reads
/// its header only: whether its arrays are whole, and that training's, `load_checkpoint` tells.
inline void check_checkpoint(const std::filesystem::path& path, const file_metadata& settings) {
    detail::check_checkpoint(safetensors_source::open(path, checksum_rule::ignore), settings);
}

/// Fills arrays from a checkpoint, after `restore` took the numbers beside them. Returns what is known of the
/// file's checksum. Throws file_error as below; `restore` refuses numbers by std::invalid_argument.
inline checksum_state load_checkpoint(const std::filesystem::path& path, std::span<const state_array> arrays,
                                      const std::function<void(std::span<const double>)>& restore,
                                      const file_metadata& settings) {
    safetensors_source file = safetensors_source::open(path);
    detail::check_checkpoint(file, settings);
    // All is read and checked before any of it is used.
    std::vector<std::variant<std::vector<float>, std::vector<double>>> states;
    for (const state_array& array : arrays)
        std::visit(
            [&](auto to) {
                file.require_extents(array.name, std::vector{to.size()});
                auto values = file.values<typename decltype(to)::value_type>(array.name);
                for (std::size_t i = 0; i < values.size(); ++i)
                    if (!std::isfinite(values[i]))
                        throw file_error(file.file(),
                                         detail::tensor_place(array.name) + ", element " + std::to_string(i),
                                         "a finite number", std::to_string(values[i]));
                states.emplace_back(std::move(values));
            },
            array.values);
    const std::vector<double> progress = file.values<double>("progress");
    try {
        restore(progress);
    } catch (const std::invalid_argument& error) {
        throw file_error(file.file(), detail::tensor_place("progress"), "the numbers of this training",
                         "'" + std::string(error.what()) + "'");
    }
    for (std::size_t index = 0; index < arrays.size(); ++index)
        std::visit(
            [&](auto to) {
                const auto& from = std::get<std::vector<typename decltype(to)::value_type>>(states[index]);
                std::copy(from.begin(), from.end(), to.begin());
            },
            arrays[index].values);
    return file.checksum();
}

/// Puts a trainer that was made with the same settings where the checkpoint left off. Throws file_error when
/// the file is no checkpoint, is damaged, has other settings, or is where such a training cannot be; the
/// trainer is then as it was. Returns what is known of the file's checksum.
template <class Trainer>
checksum_state load_checkpoint(const std::filesystem::path& path, Trainer& trainer,
                               const file_metadata& settings) {
    return load_checkpoint(
        path, state_arrays(trainer), [&](std::span<const double> numbers) { trainer.restore(numbers); },
        settings);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
