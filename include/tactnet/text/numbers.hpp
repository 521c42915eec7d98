#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <charconv>
#include <concepts>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>
#include <type_traits>
#if !defined(__cpp_lib_to_chars)
#include <locale>
#include <sstream>
#endif

// Floating-point numbers as text, also where the standard library lacks from_chars or to_chars for them, as
// libc++ does before versions 20 and 14. Independent of the locale.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A number at the start of a text.
template <std::floating_point T>
struct number_read {
    T value = 0;               ///< rounded once
    const char* end = nullptr; ///< of the number; null if there is none that `T` can hold
};

/// Reads the number without a sign that [begin, end) starts with, in any locale.
template <std::floating_point T>
[[nodiscard]] number_read<T> read_floating_point(const char* begin, const char* end) {
    number_read<T> result;
#if defined(__cpp_lib_to_chars)
    const auto [stop, code] = std::from_chars(begin, end, result.value);
    result.end = code == std::errc() ? stop : nullptr;
#else
    // A stream in the classic locale also rounds once, but takes more letters than belong to the number. So
    // the end of the number is found first.
    const char* stop = begin;
    const auto skip_digits = [&] {
        const char* const first = stop;
        while (stop != end && *stop >= '0' && *stop <= '9')
            ++stop;
        return stop - first;
    };
    auto digits = skip_digits();
    if (stop != end && *stop == '.') {
        ++stop;
        digits += skip_digits();
    }
    if (digits == 0)
        return result;
    if (stop != end && (*stop == 'e' || *stop == 'E')) {
        const char* const before = stop++;
        if (stop != end && (*stop == '+' || *stop == '-'))
            ++stop;
        if (skip_digits() == 0)
            stop = before;
    }
    std::istringstream stream(std::string(begin, stop));
    stream.imbue(std::locale::classic());
    if (stream >> result.value)
        result.end = stop;
#endif
    return result;
}

namespace detail {

template <class T>
concept written_by_standard_library =
    requires(char* text, T value) { std::to_chars(text, text, value, std::chars_format::fixed); };

/// Writes `value` by the printf format "%.*f" or "%.*e", with the fewest digits after the point that read as
/// the same number again. Returns the end, or `begin` if the text does not fit.
template <std::floating_point T>
char* print_shortest(char* begin, char* end, const char* format, T value) noexcept {
    const auto read_again = [&] {
        if constexpr (std::is_same_v<T, float>)
            return std::strtof(begin, nullptr);
        else
            return std::strtod(begin, nullptr);
    };
    int size = 0;
    for (int digits = 0;; ++digits) {
        size = std::snprintf(begin, static_cast<std::size_t>(end - begin), format, digits,
                             static_cast<double>(value));
        if (size < 0 || size >= end - begin)
            return begin;
        if (read_again() == value)
            break;
    }
    // The decimal separator of the locale becomes a point.
    char* to = begin;
    bool point = false;
    for (const char* from = begin; from != begin + size; ++from) {
        const bool plain = (*from >= '0' && *from <= '9') || *from == '-' || *from == '+' || *from == 'e';
        if (plain || !point)
            *to++ = plain ? *from : '.';
        point = point || !plain;
    }
    return to;
}

} // namespace detail

/// Room for any number in either notation: the smallest one has 324 zeros.
inline constexpr std::size_t number_letters = 400;

/// Writes the fewest letters that read as the same finite number again into [begin, end), with an exponent
/// where that is shorter. Returns the end, or `begin` if the text does not fit. Uses no heap.
template <std::floating_point T>
char* write_shortest(char* begin, char* end, T value) noexcept {
    if constexpr (detail::written_by_standard_library<T>) {
        const auto [stop, code] = std::to_chars(begin, end, value);
        return code == std::errc() ? stop : begin;
    } else {
        char other[number_letters];
        char* const fixed = detail::print_shortest(begin, end, "%.*f", value);
        const char* const scientific = detail::print_shortest(other, other + sizeof(other), "%.*e", value);
        if (fixed != begin && fixed - begin <= scientific - other)
            return fixed;
        if (scientific - other > end - begin)
            return begin;
        return std::copy(static_cast<const char*>(other), scientific, begin);
    }
}
/// The text that `write_shortest` writes.
template <std::floating_point T>
[[nodiscard]] std::string shortest_number(T value) {
    char text[number_letters];
    return {text, write_shortest(text, text + sizeof(text), value)};
}

/// The fewest digits that read as the same number again, without an exponent. `value` is finite and below
/// 1e16.
template <std::floating_point T>
[[nodiscard]] std::string fixed_number(T value) {
    char text[number_letters];
    if constexpr (detail::written_by_standard_library<T>)
        return {text, std::to_chars(text, text + sizeof(text), value, std::chars_format::fixed).ptr};
    else
        return {text, detail::print_shortest(text, text + sizeof(text), "%.*f", value)};
}

}} // namespace tactnet
