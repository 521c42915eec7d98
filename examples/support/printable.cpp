#include "printable.hpp"

#include <tactnet/text/quoting.hpp>

#include <cstddef>

namespace {

/// Whether a terminal shows the character, of well-formed UTF-8, and does nothing else.
bool only_shows(std::string_view character) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(character[i]); };
    if (character.size() == 1)
        return byte(0) >= 0x20 && byte(0) != 0x7F;
    if (character.size() == 2) // U+0080 to U+009F, of which one begins escape sequences; U+061C
        return !(byte(0) == 0xC2 && byte(1) < 0xA0) && character != "\xD8\x9C";
    // U+200E, U+200F, U+2028 to U+202E and U+2066 to U+2069: lines, paragraphs and directions.
    if (character.starts_with("\xE2\x80"))
        return !(byte(2) == 0x8E || byte(2) == 0x8F || (byte(2) >= 0xA8 && byte(2) <= 0xAE));
    return !(character.starts_with("\xE2\x81") && byte(2) >= 0xA6 && byte(2) <= 0xA9);
}

} // namespace

std::string printable(std::string_view text) {
    std::string shown;
    while (!text.empty()) {
        const std::size_t length = tactnet::utf8_sequence_length(text);
        const std::string_view character = text.substr(0, length == 0 ? 1 : length);
        if (length > 0 && only_shows(character))
            shown += character;
        else
            for (const char c : character) {
                constexpr std::string_view digits = "0123456789abcdef";
                const auto byte = static_cast<unsigned char>(c);
                shown += "\\x";
                shown += digits[byte / 16];
                shown += digits[byte % 16];
            }
        text.remove_prefix(character.size());
    }
    return shown;
}
