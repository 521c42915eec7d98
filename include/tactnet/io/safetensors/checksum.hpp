#pragma once

#include <tactnet/detail/xxh64.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

// A 64-bit checksum detects files that have changed since they were written.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Whether a file that was read is known to be undamaged.
enum class checksum_state {
    absent,   ///< the file has no checksum: damage may have gone unnoticed
    verified, ///< the checksum is right
    ignored   ///< the file has a checksum, which was not compared
};

// The text of a checksum is part of the file that it protects, and computed with zeros for its own digits. It
// begins with a rare word, so that it is recognised as a checksum even when its key is damaged.

/// The beginning of the text of a checksum.
inline constexpr std::string_view checksum_mark = "tactnet-xxh64:";
/// The number of hexadecimal digits after the mark, in small letters.
inline constexpr std::size_t checksum_digits = 16;

/// The mark and the digits of a checksum.
[[gnu::cold, gnu::noinline]] inline std::string checksum_text(std::uint64_t checksum) {
    std::string text(checksum_mark);
    for (int shift = 60; shift >= 0; shift -= 4)
        text += "0123456789abcdef"[checksum >> shift & 15U];
    return text;
}

/// The number in the text of a checksum; nothing for any other text.
[[gnu::cold]] inline std::optional<std::uint64_t> parse_checksum(std::string_view text) {
    if (text.size() != checksum_mark.size() + checksum_digits || !text.starts_with(checksum_mark))
        return std::nullopt;
    std::uint64_t value = 0;
    for (const char c : text.substr(checksum_mark.size())) {
        const std::size_t digit = std::string_view("0123456789abcdef").find(c);
        if (digit == std::string_view::npos)
            return std::nullopt;
        value = value << 4 | digit;
    }
    return value;
}

/// The checksum of bytes that contain the digits of their checksum at `place`.
inline std::uint64_t checksum_around(std::span<const std::byte> bytes, std::size_t place) {
    return xxh64()
        .update(bytes.first(place))
        .update(std::string(checksum_digits, '0'))
        .update(bytes.subspan(place + checksum_digits))
        .digest();
}

}} // namespace tactnet
