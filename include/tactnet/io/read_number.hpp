#pragma once

#include <tactnet/detail/config.hpp>

#include <charconv>
#include <concepts>
#include <string>
#include <system_error>
#if !defined(__cpp_lib_to_chars)
#include <locale>
#include <sstream>
#endif

// Reading floating-point numbers where the standard library's from_chars may lack them, as libc++'s before
// version 20 does.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A number at the start of a text. `end` is behind it, and null if there is none that the type can hold.
template <std::floating_point T>
struct number_read {
    T value = 0;               ///< rounded once
    const char* end = nullptr; ///< behind the number
};

/// Reads the number without a sign that [begin, end) starts with, in any locale.
template <std::floating_point T>
[[nodiscard]] number_read<T> read_floating_point(const char* begin, const char* end) {
    number_read<T> result;
#if defined(__cpp_lib_to_chars)
    const auto [stop, code] = std::from_chars(begin, end, result.value);
    result.end = code == std::errc() ? stop : nullptr;
#else
    // A stream in the classic locale rounds once as well. What belongs to the number is found here, as a
    // stream takes more letters.
    const char* stop = begin;
    const auto pass_digits = [&] {
        const char* const first = stop;
        while (stop != end && *stop >= '0' && *stop <= '9')
            ++stop;
        return stop - first;
    };
    auto digits = pass_digits();
    if (stop != end && *stop == '.') {
        ++stop;
        digits += pass_digits();
    }
    if (digits == 0)
        return result;
    if (stop != end && (*stop == 'e' || *stop == 'E')) {
        const char* const before = stop++;
        if (stop != end && (*stop == '+' || *stop == '-'))
            ++stop;
        if (pass_digits() == 0)
            stop = before;
    }
    std::istringstream stream(std::string(begin, stop));
    stream.imbue(std::locale::classic());
    if (stream >> result.value)
        result.end = stop;
#endif
    return result;
}

} // namespace TACTNET_ARCH
} // namespace tactnet
