#pragma once

#include <tactnet/deployment/export/header_description.hpp>
#include <tactnet/deployment/export/step_text.hpp>
#include <tactnet/detail/config.hpp>
#include <tactnet/text/message.hpp>

#include <charconv>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// Values as the text of a C++ header.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// A string literal, with bytes beyond ASCII and special characters as octal numbers.
inline std::string string_literal(std::string_view text) {
    std::string literal = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\' || c == '?') // ?: trigraphs
            (literal += '\\') += c;
        else if (code >= 0x20 && code < 0x7f)
            literal += c;
        else
            for (literal += '\\'; const int shift : {6, 3, 0})
                literal += static_cast<char>('0' + ((code >> shift) & 7));
    }
    return literal + '"';
}

/// A text for a comment of one line, without characters that could end it.
inline std::string one_line(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == '\\')
            c = ' ';
    return text;
}

/// A number in hexadecimal, which is exact and as quick to compile as decimal numbers.
template <std::floating_point Number>
std::string literal(Number value) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof(text), std::abs(value), std::chars_format::hex);
    return (std::signbit(value) ? "-0x" : "0x") + std::string(text, end.ptr) +
           (std::same_as<Number, float> ? "f" : "");
}

/// Numbers separated by commas, in lines of about a hundred characters.
template <class Number>
std::string number_lines(std::span<const Number> numbers, std::string (*text_of)(Number)) {
    std::string lines, line = "   ";
    for (const Number number : numbers) {
        const std::string text = text_of(number);
        if (line.size() + text.size() > 108) {
            lines += line + "\n";
            line = "   ";
        }
        line += " " + text + ",";
    }
    return lines + line + "\n";
}

/// Parts of a text, one after the other, with every @name@ replaced by its value.
using replacement = std::pair<std::string_view, std::string>;
inline std::string filled(std::initializer_list<std::string_view> parts,
                          std::span<const replacement> values) {
    std::string result;
    for (std::string_view text : parts)
        while (true) {
            const std::size_t begin = text.find('@');
            result += text.substr(0, begin);
            if (begin == std::string_view::npos)
                break;
            const std::size_t end = text.find('@', begin + 1);
            const std::string_view name = text.substr(begin + 1, end - begin - 1);
            for (const replacement& value : values)
                if (value.first == name)
                    result += value.second;
            text.remove_prefix(end + 1);
        }
    return result;
}

// What the headers of networks and of streams have in common. Each @name@ is replaced (detail::filled).

/// After the comment on top, which says @contents@ of what `folded` holds.
inline constexpr std::string_view header_beginning =
    R"(#pragma once

#include <@view header@>
@includes@
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace @namespace@ {
inline namespace TACTNET_ARCH {

@steps@
using recogniser_type = @type@;

/// Names of the first outputs, in order. Further outputs are unused.
inline constexpr std::array<std::string_view, @class count@> classes{
@classes@};

/// @contents@
inline constexpr std::array<float, recogniser_type::folded_elements> folded{
@numbers@};
static_assert(folded.size() == @count@, "this header does not fit this version of tactnet");

@packed@
@partners@inline constexpr recogniser_type recogniser(packed@known@);

)";

/// The end of a self-test, a function that has computed `outputs`.
inline constexpr std::string_view header_end =
    R"(    float largest = 0, difference = 0;
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const float expected = selftest_outputs[i], found = outputs[i] - expected;
        largest = largest > expected ? largest : expected;
        largest = largest > -expected ? largest : -expected;
        difference = difference > found ? difference : found;
        difference = difference > -found ? difference : -found;
    }
    return difference <= largest * 1e-4f;
}

} // namespace TACTNET_ARCH
} // namespace @namespace@
)";

inline constexpr std::string_view packed_when_compiling =
    R"(/// In the order of use, for the instruction set that this is compiled for.
inline constexpr recogniser_type::packed_weights packed = recogniser_type::pack(folded);)";

inline constexpr std::string_view packed_at_start =
    R"(/// In the order of use, for the instruction set that this is compiled for. At the latest packed before main: not for
/// use by what else happens then.
inline const recogniser_type::packed_weights packed = recogniser_type::pack(folded);)";

/// Throws std::invalid_argument if a header cannot have such names.
[[gnu::cold, gnu::noinline]] inline void require_names(const header_description& description,
                                                       std::size_t outputs) {
    if (!is_namespace_name(description.namespace_name))
        throw_invalid_argument({"deployed_header: expected a namespace such as gripper::tactile, found ",
                                quoted{description.namespace_name}});
    if (description.classes.size() > outputs)
        throw_invalid_argument({"deployed_header: expected at most ", outputs, " class names, found ",
                                description.classes.size()});
}

/// The values of the fields that all headers have, but for @type@, @view header@ and @contents@. `usual` is
/// when weights are packed, unless the description says it.
[[nodiscard]] [[gnu::cold, gnu::noinline]] inline std::vector<replacement>
common_fields(const header_description& description, const step_text& steps, std::span<const float> folded,
              header_packing usual) {
    std::string includes, classes;
    for (const std::string& header : steps.includes())
        includes += "#include <" + header + ">\n";
    for (const std::string& name : description.classes)
        classes += "    " + string_literal(name) + ",\n";
    const bool when_compiling = description.when.value_or(usual) == header_packing::when_compiling;
    return {{"network", one_line(description.network)},
            {"namespace", description.namespace_name},
            {"includes", includes},
            {"steps", steps.definitions()},
            {"class count", std::to_string(description.classes.size())},
            {"classes", classes},
            {"numbers", number_lines<float>(folded, literal<float>)},
            {"count", std::to_string(folded.size())},
            {"packed", std::string(when_compiling ? packed_when_compiling : packed_at_start)}};
}

}}} // namespace tactnet::detail
