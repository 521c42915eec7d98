#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/format.hpp>
#include <tactnet/io/safetensors/json_scanner.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

// JSON with a checksum of its own: the last member of the object, "checksum", covers all the text around its
// digits. It serves a line of JSON lines as well as a whole file; other programs see one more member.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The beginning of the member. Damage that strikes it leaves the mark after it, and the other way round.
inline constexpr std::string_view checksum_member = "\"checksum\":\"";

inline bool shows_checksum(std::string_view json) {
    return json.find(checksum_member) != std::string_view::npos ||
           json.find(checksum_mark) != std::string_view::npos;
}

/// Where the white space after a text begins.
inline std::size_t end_of_json(std::string_view json) {
    return json.find_last_not_of(" \t\n\r") + 1;
}

} // namespace detail

/// Adds a checksum to an object in JSON text. White space after the object stays, and is covered. Throws
/// std::invalid_argument for text that is no object, or that seems to have a checksum.
[[nodiscard]] [[gnu::cold]] inline std::string with_checksum(std::string_view json) {
    const std::size_t end = detail::end_of_json(json);
    if (end < 2 || json.front() != '{' || json[end - 1] != '}' || detail::shows_checksum(json))
        throw std::invalid_argument(
            detail::joined({"tactnet: expected a JSON object without a checksum, found ", in_quotes(json)}));
    std::string text(json.substr(0, end - 1));
    text += text[detail::end_of_json(text) - 1] == '{' ? "" : ",";
    text += std::string(detail::checksum_member) + checksum_text(0) + "\"}";
    const std::size_t digits = text.size() - 2 - checksum_digits;
    text += json.substr(end);
    const std::string sum = checksum_text(xxh64().update(text).digest());
    return text.replace(digits, checksum_digits, sum, checksum_mark.size(), checksum_digits);
}

/// JSON text without its checksum.
struct checked_json {
    std::string text;
    checksum_state checksum = checksum_state::absent;
};

/// Verifies and removes a checksum; text without one is returned as it is. The result is valid JSON, with
/// each key once and values nested at most 16 deep, so that a recursive reader is safe with it. `file` and
/// `part` (such as "line 3") name the text in errors. Throws file_error, also for a wrong checksum.
[[nodiscard]] [[gnu::cold]] inline checked_json check_json(std::string_view json, const std::string& file,
                                                           const std::string& part = "text") {
    checked_json result{std::string(json)};
    if (detail::shows_checksum(json)) {
        const std::size_t end = detail::end_of_json(json);
        const std::string_view object = json.substr(0, end);
        constexpr std::size_t value = checksum_mark.size() + checksum_digits;
        constexpr std::size_t member = detail::checksum_member.size() + value + 2; // and "}
        const std::size_t begin = end - std::min(end, member);
        const std::string_view tail = object.substr(begin);
        const auto expected =
            tail.size() == member && tail.starts_with(detail::checksum_member) && tail.ends_with("\"}")
                ? parse_checksum(tail.substr(detail::checksum_member.size(), value))
                : std::nullopt;
        if (!expected)
            detail::throw_file_error(file, {part}, {"a checksum as the last member"},
                                     {"one that is damaged"});
        const std::uint64_t found =
            checksum_around(std::as_bytes(std::span(json.data(), json.size())), end - 2 - checksum_digits);
        if (found != *expected)
            detail::throw_file_error(file, {"checksum of the ", part},
                                     {checksum_text(*expected), ", as when it was written"},
                                     {checksum_text(found), ": it is damaged or was changed"});
        const std::string_view before = json.substr(0, begin);
        result.text = std::string(before.ends_with(',') ? before.substr(0, begin - 1) : before) + "}" +
                      std::string(json.substr(end));
        result.checksum = checksum_state::verified;
    }
    json_scanner scanner(result.text, file, 0, part);
    scanner.skip_value();
    scanner.end();
    return result;
}

}} // namespace tactnet
