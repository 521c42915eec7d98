#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors/json_scanner.hpp>
#include <tactnet/text/numbers.hpp>
#include <tactnet/text/quoting.hpp>

#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

// What the file of a trained network says about itself in its metadata: what it is, and how its inputs are
// meant.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What a weight file says about itself. What it does not say is empty.
struct model_description {
    std::string network;
    std::optional<std::size_t> rows, columns;
    std::vector<std::string> classes;
    std::optional<double> epsilon; ///< of batch norms
    std::optional<bool> subtracts_mean;
    std::optional<float> scale;
    std::optional<std::size_t> bits{}; ///< of a weight: 8, or nothing for single precision
};

namespace detail {

/// The shortest text that reads back as the same number.
template <class Number>
std::string number_text(Number value) {
    if constexpr (std::is_floating_point_v<Number>)
        return shortest_number(value);
    else
        return std::to_string(value);
}

/// The positive number under a key. Anything else throws if the key is known to be ours (`strict`), and is
/// passed over if it may be another program's word for something else.
template <class Number>
std::optional<Number> number_in(const safetensors& file, std::string_view key, const char* expected,
                                bool strict) {
    const auto found = file.metadata().find(key);
    if (found == file.metadata().end())
        return std::nullopt;
    const std::string& text = found->second;
    Number value{};
    const char* end = nullptr;
    if constexpr (std::is_floating_point_v<Number>) {
        const auto read = read_floating_point<Number>(text.data(), text.data() + text.size());
        value = read.value, end = read.end;
    } else if (const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
               read.ec == std::errc()) {
        end = read.ptr;
    }
    if (end != text.data() + text.size() || !(value > Number{}) ||
        !std::isfinite(static_cast<double>(value))) {
        if (!strict)
            return std::nullopt;
        throw file_error(file.file(), "metadata '" + std::string(key) + "'", expected, in_quotes(text));
    }
    return value;
}

inline std::string json_array(std::span<const std::string> texts) {
    std::string json = "[";
    for (const std::string& text : texts) {
        json += json.size() > 1 ? "," : ""; // by itself: of `"," + string` GCC 12 warns (its bug 105329)
        json += json_string(text);
    }
    return json + "]";
}

} // namespace detail

/// Reads the metadata alone, to find the network that the file is for. Throws file_error for another version
/// of the format, and for values that mean nothing. Files made elsewhere may say nothing at all, or use the
/// same keys for anything: of theirs only the name and what reads as a number is taken.
[[nodiscard]] inline model_description describe_model(const safetensors& file) {
    const auto text = [&](std::string_view key) {
        const auto found = file.metadata().find(key);
        return found == file.metadata().end() ? std::string() : found->second;
    };
    model_description d;
    const bool ours = text("format") == "tactnet";
    if (ours && text("version") != "1")
        throw file_error(file.file(), "metadata 'version'", "format version 1", in_quotes(text("version")));
    d.network = text("network");
    d.rows = detail::number_in<std::size_t>(file, "rows", "a number of rows", ours);
    d.columns = detail::number_in<std::size_t>(file, "columns", "a number of columns", ours);
    d.epsilon = detail::number_in<double>(file, "epsilon", "a positive number", ours);
    if (!ours)
        return d;
    const std::string classes = text("classes"), input = text("input");
    json_scanner scanner(classes, file.file() + ": metadata 'classes'", 0);
    scanner.array([&] { d.classes.push_back(scanner.string()); });
    scanner.end();
    if (input != "mean" && input != "scale")
        throw file_error(file.file(), "metadata 'input'", "'mean' or 'scale'", in_quotes(input));
    d.subtracts_mean = input == "mean";
    d.scale = detail::number_in<float>(file, "input_scale", "a positive number", ours);
    d.bits = detail::number_in<std::size_t>(file, "bits", "'8', or none for single precision", ours);
    if (d.bits && *d.bits != 8)
        throw file_error(file.file(), "metadata 'bits'", "'8', or none for single precision",
                         in_quotes(text("bits")));
    return d;
}

/// Adds a description to the metadata of a file, in version 1 of the format. Size, classes and whether a mean
/// is subtracted must be known; the network's name is for the caller to say under "network".
inline void add_description(file_metadata& metadata, const model_description& d) {
    metadata["format"] = "tactnet";
    metadata["version"] = "1";
    metadata["rows"] = std::to_string(d.rows.value());
    metadata["columns"] = std::to_string(d.columns.value());
    metadata["classes"] = detail::json_array(d.classes);
    metadata["input"] = d.subtracts_mean.value() ? "mean" : "scale";
    if (d.epsilon)
        metadata["epsilon"] = detail::number_text(*d.epsilon);
    if (d.scale)
        metadata["input_scale"] = detail::number_text(*d.scale);
    if (d.bits)
        metadata["bits"] = std::to_string(*d.bits);
}

} // namespace TACTNET_ARCH
} // namespace tactnet
