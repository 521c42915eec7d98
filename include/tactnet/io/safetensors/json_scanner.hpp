#pragma once

#include <tactnet/detail/function_ref.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/text/numbers.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>

// Just enough JSON (RFC 8259) for the header of a safetensors file or the description of an array, which are
// untrusted text. No tree is
// built; the caller states what comes next, and each deviation is a file_error with its byte. Duplicate keys
// are rejected: readers that keep the first and readers that keep the last would see two different files.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Reads JSON text from front to back.
class json_scanner {
public:
    /// `file` and `part` name the text in errors; the text begins at byte `origin` of the file.
    json_scanner(std::string_view text, std::string file, std::size_t origin, std::string part = "header")
        : text_(text), file_(std::move(file)), part_(std::move(part)), origin_(origin) {}

    /// The position of the scanner, as a byte of the file.
    std::size_t position() const noexcept { return origin_ + position_; }

    /// Reads an object and calls `member(key)` per member, with the scanner at its value.
    [[gnu::cold]] void object(detail::function_ref<void(const std::string&)> member) {
        // A map, which the rest of a header needs too: a set would be one more container to compile.
        std::map<std::string, std::string, std::less<>> keys;
        expect('{');
        if (consume('}'))
            return;
        do {
            skip_space();
            const std::size_t at = position_;
            const std::string key = string();
            if (!keys.insert({key, std::string()}).second)
                fail_at(at, "each key once", {detail::quoted{key}, " again"});
            expect(':');
            member(key);
        } while (consume(','));
        expect('}');
    }

    /// Reads an array and calls `element()` with the scanner at each element.
    [[gnu::cold]] void array(detail::function_ref<void()> element) {
        expect('[');
        if (consume(']'))
            return;
        do
            element();
        while (consume(','));
        expect(']');
    }

    /// Reads a string with its escapes; the result is well-formed UTF-8.
    [[gnu::cold]] std::string string() {
        expect('"', "a string");
        const std::size_t at = position_;
        std::string value;
        for (;;) {
            if (position_ == text_.size())
                fail("the end of a string");
            const char c = text_[position_];
            if (static_cast<unsigned char>(c) < 0x20)
                fail("a printable character");
            ++position_;
            if (c == '"')
                break;
            if (c == '\\')
                escape(value);
            else
                value += c;
        }
        if (!is_utf8(value))
            fail_at(at, "UTF-8", {detail::quoted{value}});
        return value;
    }

    /// Reads a number without sign, fraction or exponent.
    [[gnu::cold]] std::uint64_t unsigned_integer() {
        skip_space();
        const std::size_t at = position_;
        if (!is_digit())
            fail("a whole number");
        std::uint64_t value = 0;
        while (is_digit()) {
            const auto digit = static_cast<std::uint64_t>(text_[position_] - '0');
            if (value > (std::numeric_limits<std::uint64_t>::max() - digit) / 10)
                fail_at(at, "a number below 2^64", {"a larger one"});
            value = value * 10 + digit;
            ++position_;
        }
        if (position_ - at > 1 && text_[at] == '0')
            fail_at(at, "a number without leading zeros", {detail::quoted{text_.substr(at, position_ - at)}});
        if (position_ < text_.size() && (text_[position_] == '.' || (text_[position_] | 0x20) == 'e'))
            fail("a whole number");
        return value;
    }

    /// Reads any number that a double can hold.
    [[gnu::cold]] double number() {
        skip_space();
        const std::size_t at = position_;
        skip_number();
        const bool negative = text_[at] == '-';
        const char* const begin = text_.data() + at + (negative ? 1 : 0);
        const auto [value, end] = read_floating_point<double>(begin, text_.data() + position_);
        if (end == nullptr)
            fail_at(at, "a number that a double can hold",
                    {detail::quoted{text_.substr(at, position_ - at)}});
        return negative ? -value : value;
    }

    [[gnu::cold]] bool boolean() {
        skip_space();
        const bool value = skip_word("true");
        if (!value && !skip_word("false"))
            fail("true or false");
        return value;
    }

    /// Whether a string comes next.
    [[nodiscard]] [[gnu::cold]] bool is_string() {
        skip_space();
        return position_ < text_.size() && text_[position_] == '"';
    }

    /// Reads past any value, nested at most `depth` deep, so that no text can exhaust the stack.
    [[gnu::cold]] void skip_value(int depth = 16) {
        if (depth == 0)
            fail("less nesting");
        skip_space();
        const char c = position_ < text_.size() ? text_[position_] : '\0';
        if (c == '{')
            object([&](const std::string&) { skip_value(depth - 1); });
        else if (c == '[')
            array([&] { skip_value(depth - 1); });
        else if (c == '"')
            static_cast<void>(string());
        else if (c == '-' || is_digit())
            skip_number();
        else if (!skip_word("true") && !skip_word("false") && !skip_word("null"))
            fail("a value");
    }

    /// Throws unless nothing but white space follows.
    [[gnu::cold]] void end() {
        skip_space();
        if (position_ != text_.size())
            fail("nothing more");
    }

private:
    [[gnu::cold, gnu::noinline]] void expect(char wanted, const char* what = nullptr) {
        if (consume(wanted))
            return;
        if (what != nullptr)
            fail(what);
        fail(detail::quoted{std::string_view(&wanted, 1)});
    }

    [[gnu::cold, gnu::noinline]] bool consume(char wanted) {
        skip_space();
        if (position_ == text_.size() || text_[position_] != wanted)
            return false;
        ++position_;
        return true;
    }

    bool is_digit() const {
        return position_ < text_.size() && text_[position_] >= '0' && text_[position_] <= '9';
    }

    void skip_space() { position_ = std::min(text_.find_first_not_of(" \t\n\r", position_), text_.size()); }

    [[gnu::cold, gnu::noinline]] bool skip_word(std::string_view word) {
        if (text_.substr(position_, word.size()) != word)
            return false;
        position_ += word.size();
        return true;
    }

    [[gnu::cold]] void skip_digits() {
        if (!is_digit())
            fail("a digit");
        while (is_digit())
            ++position_;
    }

    [[gnu::cold]] void skip_number() {
        static_cast<void>(skip_word("-"));
        if (!skip_word("0"))
            skip_digits();
        if (skip_word("."))
            skip_digits();
        if (skip_word("e") || skip_word("E")) {
            if (!skip_word("+"))
                static_cast<void>(skip_word("-"));
            skip_digits();
        }
    }

    [[gnu::cold]] void escape(std::string& value) {
        constexpr std::string_view letters = "\"\\/bfnrt";
        constexpr std::string_view meanings = "\"\\/\b\f\n\r\t";
        if (skip_word("u")) {
            std::uint32_t code = four_hexadecimal_digits();
            if (code >= 0xD800 && code <= 0xDBFF) {
                if (!skip_word("\\u"))
                    fail("the second half of a surrogate pair");
                const std::uint32_t low = four_hexadecimal_digits();
                if (low < 0xDC00 || low > 0xDFFF)
                    fail_at(position_ - 4, "the second half of a surrogate pair", {"another character"});
                code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
            } else if (code >= 0xDC00 && code <= 0xDFFF) {
                fail_at(position_ - 4, "a character", {"the second half of a surrogate pair alone"});
            }
            detail::append_utf8(value, code);
            return;
        }
        const auto letter =
            position_ < text_.size() ? letters.find(text_[position_]) : std::string_view::npos;
        if (letter == std::string_view::npos)
            fail("an escape of JSON");
        value += meanings[letter];
        ++position_;
    }

    [[gnu::cold, gnu::noinline]] std::uint32_t four_hexadecimal_digits() {
        std::uint32_t code = 0;
        for (int i = 0; i < 4; ++i, ++position_) {
            const char c = position_ < text_.size() ? text_[position_] : '\0';
            const char lower = static_cast<char>(c | 0x20);
            if (c >= '0' && c <= '9')
                code = code * 16 + static_cast<std::uint32_t>(c - '0');
            else if (lower >= 'a' && lower <= 'f')
                code = code * 16 + static_cast<std::uint32_t>(lower - 'a') + 10;
            else
                fail("four hexadecimal digits");
        }
        return code;
    }

    [[noreturn]] [[gnu::cold, gnu::noinline]] void fail(detail::text_part expected) const {
        if (position_ == text_.size())
            fail_at(position_, expected, {"the end of the ", part_});
        fail_at(position_, expected, {detail::quoted{text_.substr(position_, 1)}});
    }

    [[noreturn]] [[gnu::cold, gnu::noinline]] void fail_at(std::size_t position, detail::text_part expected,
                                                           detail::text_parts found) const {
        detail::throw_file_error(file_, {part_, ", byte ", origin_ + position}, {expected}, found);
    }

    std::string_view text_;
    std::string file_, part_;
    std::size_t origin_;
    std::size_t position_ = 0;
};

}} // namespace tactnet
