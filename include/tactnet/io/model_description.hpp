#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/json_scanner.hpp>
#include <tactnet/lowering/input_function.hpp>
#include <tactnet/networks/reflection_rule.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/text/numbers.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

// The metadata of a weight file: which network it is for, and how its inputs are meant.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

inline constexpr std::size_t longest_name = 200; ///< of a network, for it is shown in messages
inline constexpr const char* short_name = "a name of at most 200 bytes";

/// Why these cannot be the names of classes, with the name; empty if they can. Each must be there once, be
/// UTF-8 and have no control characters.
[[nodiscard]] [[gnu::cold, gnu::noinline]] inline std::string
problem_of_names(std::span<const std::string> names) {
    std::map<std::string, std::string, std::less<>> seen; // a type that headers of files have compiled
    for (const std::string& name : names) {
        if (name.empty())
            return "an empty name";
        if (!is_printable(name))
            return joined({quoted{name}});
        if (!seen.insert({name, std::string()}).second)
            return joined({quoted{name}, " twice"});
    }
    return {};
}
inline constexpr const char* expected_names = "names without control characters, each once";

} // namespace detail

/// What a weight file states about itself. What it does not state is empty.
struct model_description {
    std::string network;
    std::optional<std::size_t> rows, columns;
    std::vector<std::string> classes;
    std::optional<double> epsilon; ///< of batch norms
    std::optional<bool> subtracts_mean;
    std::optional<float> scale;
    std::optional<std::size_t> bits{}; ///< of a weight: 8, or nothing for single precision
    /// What logits are divided by for calibrated probabilities (temperature_scaling).
    std::optional<double> temperature{};
    std::optional<input_function> function{}; ///< of counts, before the mean is subtracted
    /// Which reflections show a class; with partners by the order of the classes.
    std::optional<reflection_rule> reflections{};
};

namespace detail {

/// Throws file_error for the metadata under a key, which is `found` or missing.
[[noreturn]] [[gnu::cold, gnu::noinline]] inline void throw_metadata_error(const safetensors_index& file,
                                                                           std::string_view key,
                                                                           std::string_view expected,
                                                                           const std::string* found) {
    throw_file_error(file.file(), {"metadata '", key, "'"}, {expected},
                     {found == nullptr ? text_part("none") : quoted{*found}});
}

/// The positive number under a key. Any other text is an error in a file of this library (`ours`), and
/// ignored in files of other programs, which may use the key for something else.
template <class Number>
std::optional<Number> number_in(const safetensors_index& file, std::string_view key, const char* expected,
                                bool ours) {
    const std::string* const text = file.find_metadata(key);
    if (text == nullptr)
        return std::nullopt;
    Number value{};
    const char *const begin = text->data(), *const end = begin + text->size();
    const char* stop = nullptr;
    if constexpr (std::is_floating_point_v<Number>) {
        const auto read = read_floating_point<Number>(begin, end);
        value = read.value, stop = read.end;
    } else if (const auto read = std::from_chars(begin, end, value); read.ec == std::errc()) {
        stop = read.ptr;
    }
    if (stop == end && value > Number{} && std::isfinite(static_cast<double>(value)))
        return value;
    if (ours)
        throw_metadata_error(file, key, expected, text);
    return std::nullopt;
}

/// The partner of each class by a JSON array of names; empty without one.
inline std::vector<std::size_t> partners_in(const safetensors_index& file, std::string_view key,
                                            std::span<const std::string> classes) {
    std::vector<std::size_t> partners;
    const std::string* const text = file.find_metadata(key);
    if (text == nullptr)
        return partners;
    json_scanner scanner(*text, joined({file.file(), ": metadata '", key, "'"}), 0);
    scanner.array([&] {
        partners.push_back(static_cast<std::size_t>(
            std::find(classes.begin(), classes.end(), scanner.string()) - classes.begin()));
    });
    scanner.end();
    if (partners.empty() || partners.size() != classes.size() || !are_mutual(partners))
        throw_metadata_error(file, key, "the name of a class for each class, in pairs", text);
    return partners;
}

} // namespace detail

/// Reads the metadata alone, to find the network that the file is for. Throws file_error for another version
/// of the format, and for invalid values. Files of other programs may have no metadata, or use the same keys
/// for anything: only their name and valid numbers are read.
[[nodiscard]] [[gnu::cold]] inline model_description describe_model(const safetensors_index& file) {
    const auto text = [&](std::string_view key) {
        const std::string* const found = file.find_metadata(key);
        return found == nullptr ? std::string() : *found;
    };
    const auto require = [&](bool holds, std::string_view key, std::string_view expected) {
        const std::string found = text(key);
        if (!holds)
            detail::throw_metadata_error(file, key, expected, &found);
    };
    constexpr const char* eight_bits = "'8', or none for single precision";
    model_description d;
    const bool ours = text("format") == "tactnet";
    require(!ours || text("version") == "1", "version", "format version 1");
    d.network = text("network");
    require(d.network.size() <= detail::longest_name, "network", detail::short_name);
    d.rows = detail::number_in<std::size_t>(file, "rows", "a number of rows", ours);
    d.columns = detail::number_in<std::size_t>(file, "columns", "a number of columns", ours);
    d.epsilon = detail::number_in<double>(file, "epsilon", "a positive number", ours);
    if (!ours)
        return d;
    if (file.find_metadata("classes") == nullptr)
        detail::throw_file_error(file.file(), {"metadata 'classes'"}, {"names as a JSON array"},
                                 {file.find_metadata("machine") == nullptr
                                      ? "none"
                                      : "none: a support vector machine, for load_kernel_machine or "
                                        "load_linear_machine"});
    const std::string classes = text("classes"), input = text("input");
    json_scanner scanner(classes, detail::joined({file.file(), ": metadata 'classes'"}), 0);
    scanner.array([&] { d.classes.push_back(scanner.string()); });
    scanner.end();
    if (const std::string problem = detail::problem_of_names(d.classes); !problem.empty())
        detail::throw_file_error(file.file(), {"metadata 'classes'"}, {detail::expected_names}, {problem});
    require(input == "mean" || input == "scale", "input", "'mean' or 'scale'");
    d.subtracts_mean = input == "mean";
    d.scale = detail::number_in<float>(file, "input_scale", "a positive number", ours);
    d.bits = detail::number_in<std::size_t>(file, "bits", eight_bits, ours);
    require(!d.bits || *d.bits == 8, "bits", eight_bits);
    constexpr const char* temperatures = "a number from 0.001 to 1000";
    d.temperature = detail::number_in<double>(file, "temperature", temperatures, ours);
    require(!d.temperature || is_temperature(*d.temperature), "temperature", temperatures);
    if (const std::string rule = text("input_function"); !rule.empty()) {
        const auto found = std::find(count_rule_names.begin(), count_rule_names.end(), rule);
        require(found != count_rule_names.end(), "input_function",
                "'identity', 'root', 'log' or 'relative-log'");
        d.function = {static_cast<count_rule>(found - count_rule_names.begin()),
                      detail::number_in<float>(file, "input_knee", "a positive number", ours).value_or(1.0F)};
        require(d.function->valid(), "input_knee", "a number from 0.001 to 1000000");
    }
    if (const std::string axes = text("reflected_axes"); !axes.empty()) {
        const bool both = axes == "both";
        require(both || axes == "none" || axes == "rows" || axes == "columns", "reflected_axes",
                "'none', 'rows', 'columns' or 'both'");
        d.reflections = {
            {both || axes == "rows", detail::partners_in(file, "row_partners", d.classes)},
            {both || axes == "columns", detail::partners_in(file, "column_partners", d.classes)}};
    }
    return d;
}

}} // namespace tactnet
