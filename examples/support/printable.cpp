#include "printable.hpp"

#include <tactnet/text/quoting.hpp>

#include <cstddef>

std::string printable(std::string_view text) {
    std::string shown;
    while (!text.empty()) {
        const std::size_t length = tactnet::utf8_sequence_length(text);
        const std::string_view character = text.substr(0, length == 0 ? 1 : length);
        if (length > 0 && tactnet::is_visible(character))
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
