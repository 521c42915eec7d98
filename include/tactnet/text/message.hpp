#pragma once

#include <tactnet/detail/config.hpp>

#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>

// Messages made of texts and whole numbers.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// A part of a message: a text or a whole number.
struct text_part {
    text_part(const char* part) : text(part) {}
    text_part(std::string_view part) : text(part) {}
    text_part(const std::string& part) : text(part) {}
    text_part(std::uintmax_t part) : number(part), is_number(true) {}

    std::string_view text;
    std::uintmax_t number = 0;
    bool is_number = false;
};
using text_parts = std::initializer_list<text_part>;

/// Joins the parts of a message. Not inlined, since concatenation would be most of the code at the place of
/// an error.
[[gnu::cold, gnu::noinline]] inline std::string joined(text_parts parts) {
    std::string text;
    for (const text_part& part : parts)
        part.is_number ? text += std::to_string(part.number) : text += part.text;
    return text;
}

/// Throws std::invalid_argument with the parts as its message.
[[noreturn]] [[gnu::cold, gnu::noinline]] inline void throw_invalid_argument(text_parts parts) {
    throw std::invalid_argument(joined(parts));
}

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet
