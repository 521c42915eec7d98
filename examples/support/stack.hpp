#pragma once

// The stack that the system gives a program.

#if defined(__unix__) || defined(__APPLE__)
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <initializer_list>
#include <string_view>
#include <sys/resource.h>
#include <unistd.h>
#endif

/// At the beginning of a program: ends it with a message and exit status 2 if its stack, which its threads
/// have as well, is limited to less than 2 MiB. A workspace takes up to 1 MiB of it; overflow would be a
/// crash.
inline void require_stack([[maybe_unused]] const char* program) noexcept {
#if defined(__unix__) || defined(__APPLE__)
    constexpr rlim_t least = rlim_t{2} << 20U;
    struct rlimit limit {};
    if (::getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= least)
        return;
    char digits[24];
    const auto end = std::to_chars(digits, digits + sizeof(digits), limit.rlim_cur / 1024).ptr;
    // std::fprintf takes more stack than there may be.
    for (const std::string_view part :
         {std::string_view(program), std::string_view(": expected a stack of 2048 KiB or more, found "),
          std::string_view(digits, static_cast<std::size_t>(end - digits)),
          std::string_view(" KiB (see ulimit -s)\n")})
        static_cast<void>(!::write(STDERR_FILENO, part.data(), part.size()));
    std::_Exit(2);
#endif
}
