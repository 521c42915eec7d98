#pragma once

#include <tactnet/detail/function_ref.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/format.hpp>
#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/io/stored_arrays.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/text/numbers.hpp>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

// A stopped training that can be resumed bit-identically. A checkpoint stores the settings of its training
// (network, recipe, seed, data, …) as text: resuming with others would give a network that no settings
// describe, so it is an error that names the difference.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A view of one named array of a trainer, without the trainer's type: of floats or of doubles.
struct state_array {
    std::string name;
    std::span<float> floats = {};
    std::span<double> doubles = {}; ///< or empty
    std::vector<bool> squares = {}; ///< of floats, those that are never below zero; further ones may be
};

namespace detail {

template <class Trainer>
[[nodiscard]] std::vector<bool> squares_of(Trainer& trainer, std::string_view name) {
    if constexpr (requires { trainer.squares(name); })
        return trainer.squares(name);
    else
        return {};
}
/// Views of the arrays of a trainer, which must outlive them.
template <class Trainer>
[[nodiscard]] std::vector<state_array> state_arrays(Trainer& trainer) {
    std::vector<state_array> arrays;
    trainer.for_each_state([&](std::string_view name, auto values) {
        if constexpr (std::is_convertible_v<decltype(values), std::span<float>>)
            arrays.push_back({std::string(name), values, {}, squares_of(trainer, name)});
        else
            arrays.push_back({std::string(name), {}, values, {}});
    });
    return arrays;
}

} // namespace detail

/// Writes arrays and the numbers of the progress, all or nothing. Throws file_error.
[[gnu::cold]] inline void save_checkpoint(const std::filesystem::path& path,
                                          std::span<const state_array> arrays,
                                          std::span<const double> progress, const file_metadata& settings) {
    safetensors_writer writer;
    for (const auto& [key, value] : settings)
        writer.metadata["setting." + key] = value;
    writer.metadata["format"] = "tactnet checkpoint";
    writer.metadata["version"] = "1";
    for (const state_array& array : arrays)
        if (array.doubles.empty())
            writer.add(array.name, {array.floats.size()}, std::span<const float>(array.floats));
        else
            writer.add(array.name, {array.doubles.size()}, std::span<const double>(array.doubles));
    writer.add("progress", {progress.size()}, progress);
    writer.write(path);
}

/// Writes all that `trainer` needs to resume, all or nothing. Resuming requires the same `settings`. Throws
/// file_error.
template <class Trainer>
void save_checkpoint(const std::filesystem::path& path, Trainer& trainer, const file_metadata& settings) {
    save_checkpoint(path, detail::state_arrays(trainer), trainer.progress(), settings);
}

namespace detail {

/// Throws file_error unless the file is a checkpoint of a training with these settings.
[[gnu::cold]] inline void check_checkpoint(const safetensors_index& file, const file_metadata& settings) {
    const auto require = [&](const std::string& key, const std::string& value, text_parts place,
                             text_parts expected) {
        const std::string* const found = file.find_metadata(key);
        if (found == nullptr || *found != value)
            throw_file_error(file.file(), place, expected, {found == nullptr ? "none" : in_quotes(*found)});
    };
    require("format", "tactnet checkpoint", {"metadata 'format'"}, {"'tactnet checkpoint'"});
    require("version", "1", {"metadata 'version'"}, {"version 1"});
    for (const auto& [key, value] : settings)
        require("setting." + key, value, {"setting '", key, "' of the stopped training"}, {in_quotes(value)});
}

/// Reads a state array of so many elements, which must be finite; nothing for none.
template <class T>
[[nodiscard]] std::vector<T> read_state(safetensors_source& file, const std::string& name, std::size_t size) {
    file.require_extents(name, std::vector{size});
    std::vector<T> values = file.values<T>(name);
    check_values(file, name, std::span<const T>(values), false);
    return values;
}

} // namespace detail

/// Throws file_error unless the file states that it is a checkpoint of a training with these settings. Reads
/// only its header; `load_checkpoint` checks the arrays.
[[gnu::cold]] inline void check_checkpoint(const std::filesystem::path& path, const file_metadata& settings) {
    detail::check_checkpoint(safetensors_source::open(path, checksum_rule::ignore), settings);
}

/// Fills arrays from a checkpoint, after `restore` took the numbers of the progress. Returns the state of the
/// file's checksum. Throws file_error as below; `restore` rejects numbers with std::invalid_argument.
[[gnu::cold]] inline checksum_state
load_checkpoint(const std::filesystem::path& path, std::span<const state_array> arrays,
                detail::function_ref<void(std::span<const double>)> restore, const file_metadata& settings) {
    safetensors_source file = safetensors_source::open(path);
    detail::check_checkpoint(file, settings);
    // All is read and checked before any of it is used.
    std::vector<std::vector<float>> floats;
    std::vector<std::vector<double>> doubles;
    for (const state_array& array : arrays)
        if (array.doubles.empty()) {
            floats.push_back(detail::read_state<float>(file, array.name, array.floats.size()));
            for (std::size_t i = 0; i < array.squares.size(); ++i)
                if (const float found = floats.back()[i]; array.squares[i] && found < 0)
                    detail::throw_element_error(file.file(), array.name, i,
                                                "a square or a variance (at least 0)",
                                                shortest_number(found));
        } else {
            doubles.push_back(detail::read_state<double>(file, array.name, array.doubles.size()));
        }
    const std::vector<double> progress = file.values<double>("progress");
    try {
        restore(progress);
    } catch (const std::invalid_argument& error) {
        detail::throw_tensor_error(file.file(), "progress", {"the numbers of this training"},
                                   {"'", error.what(), "'"});
    }
    auto next_floats = floats.begin();
    auto next_doubles = doubles.begin();
    for (const state_array& array : arrays)
        if (array.doubles.empty())
            std::copy(next_floats->begin(), next_floats->end(), array.floats.begin()), ++next_floats;
        else
            std::copy(next_doubles->begin(), next_doubles->end(), array.doubles.begin()), ++next_doubles;
    return file.checksum();
}

/// Restores a trainer that was made with the same settings to the state of a checkpoint. Throws file_error
/// when the file is no checkpoint, is damaged, has other settings, or a state that such a training cannot
/// have; the trainer is then unchanged. Returns the state of the file's checksum.
template <class Trainer>
checksum_state load_checkpoint(const std::filesystem::path& path, Trainer& trainer,
                               const file_metadata& settings) {
    return load_checkpoint(
        path, detail::state_arrays(trainer),
        [&](std::span<const double> numbers) { trainer.restore(numbers); }, settings);
}

}} // namespace tactnet
