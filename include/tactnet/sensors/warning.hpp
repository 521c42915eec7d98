#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/text/numbers.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

// Warnings of a decoder: bytes that the format allows, but no known program writes. In a format without a
// checksum they may be damage, or come from an unknown program. Adding warnings uses no heap, since there may
// be many.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// For example "byte 812, line 31, frame 1". A line or frame of 0 is left out.
[[nodiscard]] inline std::string place_text(std::size_t byte, std::size_t line, std::uint64_t frame) {
    return "byte " + std::to_string(byte) + (line > 0 ? ", line " + std::to_string(line) : "") +
           (frame > 0 ? ", frame " + std::to_string(frame) : "");
}

} // namespace detail

/// A short text from texts and numbers, without heap. It is truncated to `capacity`.
class warning_text {
public:
    static constexpr std::size_t capacity = 103;

    warning_text() noexcept = default;
    template <class... Parts>
        requires((std::is_arithmetic_v<Parts> || std::convertible_to<Parts, std::string_view>) && ...)
    explicit warning_text(Parts... parts) noexcept {
        (append(parts), ...);
    }

    [[nodiscard]] std::string_view view() const noexcept { return {letters_.data(), size_}; }
    friend bool operator==(const warning_text& a, const warning_text& b) noexcept {
        return a.view() == b.view();
    }

private:
    void append(std::string_view text) noexcept {
        const std::size_t fits = std::min(text.size(), capacity - size_);
        std::copy_n(text.begin(), fits, letters_.begin() + size_);
        size_ = static_cast<std::uint8_t>(size_ + fits);
    }
    template <class Number>
        requires std::is_arithmetic_v<Number>
    void append(Number number) noexcept {
        std::array<char, 32> digits{};
        char* const begin = digits.data();
        char* end = begin;
        if constexpr (std::is_floating_point_v<Number>)
            end = write_shortest(begin, begin + digits.size(), number);
        else
            end = std::to_chars(begin, begin + digits.size(), number).ptr;
        append(std::string_view(begin, static_cast<std::size_t>(end - begin)));
    }

    std::array<char, capacity> letters_{};
    std::uint8_t size_ = 0;
};

/// A warning and its place.
struct decoding_warning {
    std::size_t byte = 0;    ///< offset from the first byte pushed
    std::size_t line = 0;    ///< from 1; 0 outside of a text header
    std::uint64_t frame = 0; ///< position of the frame, from 1; 0 in a header
    warning_text expected{}, found{};

    [[nodiscard]] std::string place() const { return detail::place_text(byte, line, frame); }
    /// The warning as a sentence: "file: place: expected …, found …".
    [[nodiscard]] std::string message(const std::string& file = {}) const {
        return error_sentence(file, place(), expected.view(), found.view());
    }
    friend bool operator==(const decoding_warning&, const decoding_warning&) = default;
};

/// The first warnings of a source, and the number of all.
class decoding_warnings {
public:
    /// Number of warnings kept.
    static constexpr std::size_t capacity = 16;

    void add(const decoding_warning& warning) noexcept {
        if (count_ < capacity)
            kept_[static_cast<std::size_t>(count_)] = warning;
        ++count_;
    }

    /// Number of all warnings.
    [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
    /// The first warnings.
    [[nodiscard]] std::span<const decoding_warning> kept() const& noexcept {
        return std::span(kept_).first(static_cast<std::size_t>(std::min<std::uint64_t>(count_, capacity)));
    }
    void kept() const&& = delete; // would dangle

private:
    std::array<decoding_warning, capacity> kept_{};
    std::uint64_t count_ = 0;
};

}} // namespace tactnet
