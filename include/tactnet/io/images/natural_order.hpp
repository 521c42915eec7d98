#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Whether `a` comes before `b` when runs of digits count as numbers: "key2" before "key10". A strict total
/// order on bytes, independent of the locale; numbers that differ in leading zeros only are put in order by
/// their bytes.
inline bool natural_less(std::string_view a, std::string_view b) noexcept {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    // Takes a number off the front, without its leading zeros: of any length, so it stays text.
    const auto take_number = [&](std::string_view& text) {
        std::size_t end = 0;
        while (end < text.size() && is_digit(text[end]))
            ++end;
        std::string_view number = text.substr(0, end);
        text.remove_prefix(end);
        number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
        return number;
    };
    std::string_view rest_a = a, rest_b = b;
    while (!rest_a.empty() && !rest_b.empty()) {
        if (is_digit(rest_a.front()) && is_digit(rest_b.front())) {
            const std::string_view number_a = take_number(rest_a), number_b = take_number(rest_b);
            if (number_a.size() != number_b.size())
                return number_a.size() < number_b.size();
            if (const int order = number_a.compare(number_b); order != 0)
                return order < 0;
        } else {
            if (rest_a.front() != rest_b.front())
                return static_cast<unsigned char>(rest_a.front()) <
                       static_cast<unsigned char>(rest_b.front());
            rest_a.remove_prefix(1);
            rest_b.remove_prefix(1);
        }
    }
    if (rest_a.empty() != rest_b.empty())
        return rest_a.empty();
    return a < b;
}

} // namespace TACTNET_ARCH
} // namespace tactnet
