#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors/json_scanner.hpp>
#include <tactnet/sensors/described/description.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/text/numbers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

// The description of an array as a JSON file, whose keys are the names of the members. What is left out has
// its default:
//
//     {"rows": 16, "columns": 16, "cell": "uint16", "marker": "AA 55", "checksum": {"kind": "crc16"}}

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The words of an enumeration in a file, in the order of its values.
constexpr auto words_of(cell_type) noexcept {
    return std::to_array<std::string_view>({"uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64",
                                            "int64", "float32", "float64", "digits"});
}
constexpr auto words_of(byte_order) noexcept {
    return std::to_array<std::string_view>({"little", "big"});
}
constexpr auto words_of(cell_order) noexcept {
    return std::to_array<std::string_view>({"rows", "columns"});
}
constexpr auto words_of(block_order) noexcept {
    return std::to_array<std::string_view>({"one", "side by side", "stacked"});
}
constexpr auto words_of(line_content) noexcept {
    return std::to_array<std::string_view>({"frame", "row"});
}
constexpr auto words_of(checksum_kind) noexcept {
    return std::to_array<std::string_view>({"none", "sum8", "sum16", "xor8", "crc8", "crc16"});
}

/// Calls visit(name, member) for each field of a checksum.
template <class Checksum, class Visit>
    requires std::same_as<std::remove_const_t<Checksum>, packet_checksum>
void visit_fields(Checksum& c, Visit&& visit) {
    visit("kind", c.kind), visit("with_marker", c.with_marker), visit("negated", c.negated);
    visit("byte_order", c.order), visit("polynomial", c.polynomial), visit("initial", c.initial);
    visit("final_xor", c.final_xor), visit("reflected", c.reflected);
}
/// Calls visit(name, member) for each field of a description.
template <class Description, class Visit>
    requires std::same_as<std::remove_const_t<Description>, sensor_description>
void visit_fields(Description& d, Visit&& visit) {
    visit("rows", d.rows), visit("columns", d.columns), visit("cell", d.cell),
        visit("byte_order", d.cell_bytes);
    visit("order", d.order), visit("serpentine", d.serpentine), visit("blocks", d.blocks);
    visit("transposed", d.transposed), visit("flipped_rows", d.flipped_rows);
    visit("flipped_columns", d.flipped_columns), visit("rotation", d.rotation);
    visit("marker", d.marker), visit("header_bytes", d.header_bytes), visit("trailer_bytes", d.trailer_bytes);
    visit("checksum", d.checksum), visit("end_bytes", d.end_bytes);
    visit("line", d.line), visit("header_lines", d.header_lines), visit("leading_fields", d.leading_fields);
    visit("decimal_comma", d.decimal_comma), visit("seconds_per_tick", d.seconds_per_tick);
    visit("seconds_per_frame", d.seconds_per_frame), visit("offset", d.offset), visit("inverted", d.inverted);
    visit("negative_is_zero", d.negative_is_zero), visit("full_scale", d.full_scale);
    visit("full_scale_pressure", d.full_scale_pressure), visit("in_pascal", d.in_pascal);
    visit("broken", d.broken), visit("broken_above", d.broken_above);
    visit("row_spacing", d.row_spacing), visit("column_spacing", d.column_spacing);
}

/// Reads a description out of JSON. A value that cannot be is a file_error that names its field.
class description_reader {
public:
    description_reader(std::string_view text, std::string file)
        : json_(text, file, 0, "description"), file_(std::move(file)) {}

    [[nodiscard]] sensor_description read() {
        sensor_description result;
        read(result, "");
        json_.end();
        if (const auto problem = problem_of(result))
            fail(problem->field, {problem->expected}, {problem->found});
        return result;
    }

private:
    [[noreturn]] void fail(std::string_view field, text_parts expected, text_parts found) const {
        throw_file_error(file_, {"field ", quoted{field}}, expected, found);
    }

    template <class Fields>
        requires requires(Fields& f) { visit_fields(f, [](const char*, const auto&) {}); }
    void read(Fields& fields, std::string_view) {
        json_.object([&](const std::string& key) {
            bool known = false;
            visit_fields(fields, [&](std::string_view name, auto& member) {
                if (name == key) {
                    read(member, name);
                    known = true;
                }
            });
            if (!known) {
                std::string names;
                visit_fields(fields, [&](const char* name, const auto&) {
                    names += (names.empty() ? "" : ", ") + std::string(name);
                });
                fail(key, {"one of: ", names}, {quoted{key}});
            }
        });
    }
    template <class Enum>
        requires std::is_enum_v<Enum>
    void read(Enum& value, std::string_view field) {
        const std::string word = json_.string();
        const auto words = words_of(value);
        const auto found = std::find(words.begin(), words.end(), word);
        if (found == words.end()) {
            std::string known;
            for (const std::string_view each : words)
                known += (known.empty() ? "'" : ", '") + std::string(each) + "'";
            fail(field, {"one of ", known}, {quoted{word}});
        }
        value = static_cast<Enum>(found - words.begin());
    }
    template <std::unsigned_integral Number>
    void read(Number& value, std::string_view field) {
        if constexpr (std::same_as<Number, bool>) {
            value = json_.boolean();
        } else {
            const std::uint64_t number = json_.unsigned_integer();
            if (number > std::numeric_limits<Number>::max())
                fail(field, {"at most ", std::numeric_limits<Number>::max()}, {number});
            value = static_cast<Number>(number);
        }
    }
    void read(double& value, std::string_view) { value = json_.number(); }
    void read(std::optional<double>& value, std::string_view) { value = json_.number(); }
    /// Values that mark a broken cell: numbers, "nan", "inf", "-inf".
    void read(std::vector<double>& values, std::string_view field) {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        values.clear();
        json_.array([&] {
            if (!json_.is_string())
                return values.push_back(json_.number());
            const std::string word = json_.string();
            if (word != "nan" && word != "inf" && word != "-inf")
                fail(field, {"a number, 'nan', 'inf' or '-inf'"}, {quoted{word}});
            values.push_back(word == "nan"   ? std::numeric_limits<double>::quiet_NaN()
                             : word == "inf" ? infinity
                                             : -infinity);
        });
    }
    /// Bytes in hexadecimal digits.
    void read(std::vector<std::byte>& bytes, std::string_view field) {
        constexpr std::string_view digits = "0123456789abcdef";
        const std::string text = json_.string();
        std::size_t count = 0;
        bytes.clear();
        for (const char c : text) {
            if (c == ' ')
                continue;
            const std::size_t digit =
                digits.find(c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c);
            if (digit == std::string_view::npos)
                fail(field, {"hexadecimal bytes such as 'AA 55'"}, {quoted{text}});
            if (count++ % 2 == 0)
                bytes.push_back(static_cast<std::byte>(digit << 4U));
            else
                bytes.back() |= static_cast<std::byte>(digit);
        }
        if (count % 2 != 0)
            fail(field, {"two hexadecimal digits for each byte"}, {quoted{text}});
    }

    json_scanner json_;
    std::string file_;
};

template <class Value>
[[nodiscard]] std::string description_json(const Value& value) {
    if constexpr (std::is_enum_v<Value>) {
        return json_string(words_of(value)[static_cast<std::size_t>(value)]);
    } else if constexpr (std::same_as<Value, bool>) {
        return value ? "true" : "false";
    } else if constexpr (std::is_integral_v<Value>) {
        return std::to_string(value);
    } else if constexpr (std::same_as<Value, double>) {
        return std::isnan(value)   ? "\"nan\""
               : std::isinf(value) ? (value > 0 ? "\"inf\"" : "\"-inf\"")
                                   : shortest_number(value);
    } else if constexpr (std::same_as<Value, std::optional<double>>) {
        return value ? description_json(*value) : "";
    } else if constexpr (std::same_as<Value, std::vector<double>>) {
        std::string text = "[";
        for (const double each : value)
            text += (text.size() > 1 ? ", " : "") + description_json(each);
        return text + "]";
    } else if constexpr (std::same_as<Value, std::vector<std::byte>>) {
        constexpr std::string_view digits = "0123456789ABCDEF";
        std::string text = "\"";
        for (const std::byte each : value) {
            const auto byte = std::to_integer<unsigned>(each);
            text += (text.size() > 1 ? " " : "") + std::string{digits[byte >> 4U], digits[byte & 15U]};
        }
        return text + "\"";
    } else {
        const auto fields = [](const Value& of) {
            std::vector<std::pair<std::string, std::string>> texts;
            visit_fields(of, [&](const char* name, const auto& member) {
                texts.emplace_back(name, description_json(member));
            });
            return texts;
        };
        const auto here = fields(value), usual = fields(Value{});
        std::string text;
        for (std::size_t i = 0; i < here.size(); ++i)
            if (here[i] != usual[i])
                text += (text.empty() ? "" : ", ") + json_string(here[i].first) + ": " + here[i].second;
        return "{" + text + "}";
    }
}

} // namespace detail

/// The description in JSON: what differs from the defaults.
[[nodiscard]] inline std::string sensor_json(const sensor_description& description) {
    return detail::description_json(description);
}

/// Reads a description from JSON; `file` names it in errors. Throws file_error with the byte of what is no
/// JSON, or the field that cannot be.
[[nodiscard]] inline sensor_description parse_sensor(std::string_view json, std::string file = {}) {
    return detail::description_reader(json, std::move(file)).read();
}

/// Reads the description in a file of JSON. Throws file_error, also if the file cannot be read.
[[nodiscard]] inline sensor_description read_sensor(const std::filesystem::path& path) {
    constexpr std::size_t largest = std::size_t{1} << 24;
    const std::vector<std::byte> bytes = read_file(path, largest);
    return parse_sensor({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path.string());
}

}} // namespace tactnet
