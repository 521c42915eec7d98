#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Options for writing a deployed network as a header (deployed_header.hpp).

namespace tactnet { inline namespace TACTNET_ARCH {

/// When a program packs the weights of a header. Neither uses the heap.
enum class header_packing {
    when_compiling, ///< into read-only memory. Clang needs -fconstexpr-steps=10000000 for TactNet-6, and
                    ///< GCC for 32-bit ARM -fconstexpr-ops-limit=100000000 in 8 bits
    at_start        ///< into static memory before main, or earlier if the compiler's limits allow it
};
/// The earliest packing within the default limits of GCC 12 and Clang 14 for every instruction set: Clang
/// allows 1 048 576 steps, and needs 76 to 94 per weight of a Winograd convolution.
[[nodiscard]] constexpr header_packing usual_packing(std::size_t folded_elements) {
    return folded_elements <= 8192 ? header_packing::when_compiling : header_packing::at_start;
}

/// The text of a header besides its numbers.
struct header_description {
    std::string network;              ///< its name, for the comment on top; one line
    std::string namespace_name;       ///< the enclosing namespace: an identifier, or several with :: between
    std::vector<std::string> classes; ///< names of the first outputs, in order; may be fewer than outputs
    std::optional<header_packing> when = {}; ///< by default usual_packing
};

/// Whether a text is an identifier, or several with :: between, that a program may define as namespaces: no
/// keyword, no reserved name, nothing that looks like a macro (CAPITALS_WITH_UNDERSCORES), and neither
/// `tactnet` nor `std`, which would hide the real ones. The first one is no common function of the C library,
/// such as `time`; which others there are differs from system to system.
[[nodiscard]] inline bool is_namespace_name(std::string_view text) {
    constexpr std::string_view never =
        " alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t "
        "char8_t class co_await co_return co_yield compl concept const const_cast consteval constexpr "
        "constinit continue decltype default delete do double dynamic_cast else enum explicit export extern "
        "false float for friend goto if inline int long mutable namespace new noexcept not not_eq nullptr "
        "operator or or_eq private protected public register reinterpret_cast requires return short signed "
        "sizeof static static_assert static_cast struct switch template this thread_local throw true try "
        "typedef typeid typename union unsigned using virtual void volatile wchar_t while xor xor_eq "
        "main posix std tactnet linux unix " // the last two are macros of GCC and Clang by default
        "BUFSIZ EDOM EILSEQ EOF ERANGE INFINITY NAN NULL SIGABRT SIGINT SIGTERM WEOF "
        "assert errno offsetof setjmp stderr stdin stdout va_arg va_copy va_end va_start ";
    constexpr std::string_view never_first =
        " abort abs acos asin atan calloc ceil clock cos div erf exit exp floor free gamma getenv hypot "
        "index isnan log log2 lround malloc memchr memcmp memcpy memmove memset nan pow printf putchar puts "
        "qsort rand realloc remove rename rint round scanf signal sin sqrt sscanf strcmp strlen system tan "
        "time trunc y0 y1 yn ";
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    const auto small = [](char c) { return c >= 'a' && c <= 'z'; };
    for (bool first = true;; first = false) {
        const std::string_view name = text.substr(0, text.find(':'));
        const auto stands_in = [word = std::string(1, ' ').append(name).append(1, ' ')](
                                   std::string_view names) { return names.find(word) != names.npos; };
        const auto is_macro = [&] {
            return name.find('_') != name.npos && std::none_of(name.begin(), name.end(), small);
        };
        if (name.empty() || name[0] == '_' || !letter(name[0]) ||
            !std::all_of(name.begin(), name.end(),
                         [&](char c) { return letter(c) || (c >= '0' && c <= '9'); }) ||
            name.find("__") != name.npos || stands_in(never) || (first && stands_in(never_first)) ||
            is_macro())
            return false;
        if (name.size() == text.size())
            return true;
        text.remove_prefix(name.size());
        if (!text.starts_with("::"))
            return false;
        text.remove_prefix(2);
    }
}

}} // namespace tactnet
