#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/xxh64.hpp>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

// The element types of stored tensors, as the safetensors format names them, and the two 16-bit
// floating-point formats that C++20 has no type for.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The type of the elements of a stored array, by the names of safetensors.
enum class element_type {
    boolean,
    uint8,
    int8,
    int16,
    uint16,
    float16,
    bfloat16,
    int32,
    uint32,
    float32,
    float64,
    int64,
    uint64
};

namespace detail {

struct element_type_row {
    element_type type;
    std::string_view name;
    std::size_t size;
};

// In the order of the enumeration, so that a type is its own index.
inline constexpr std::array<element_type_row, 13> element_type_table{{
    {element_type::boolean, "BOOL", 1},
    {element_type::uint8, "U8", 1},
    {element_type::int8, "I8", 1},
    {element_type::int16, "I16", 2},
    {element_type::uint16, "U16", 2},
    {element_type::float16, "F16", 2},
    {element_type::bfloat16, "BF16", 2},
    {element_type::int32, "I32", 4},
    {element_type::uint32, "U32", 4},
    {element_type::float32, "F32", 4},
    {element_type::float64, "F64", 8},
    {element_type::int64, "I64", 8},
    {element_type::uint64, "U64", 8},
}};

} // namespace detail

/// The size of one element in bytes.
constexpr std::size_t element_size(element_type type) noexcept {
    return detail::element_type_table[static_cast<std::size_t>(type)].size;
}

/// The name in a file: "F32", "U8", ….
constexpr std::string_view element_type_name(element_type type) noexcept {
    return detail::element_type_table[static_cast<std::size_t>(type)].name;
}

/// The inverse of element_type_name; nothing for a name that is not known.
constexpr std::optional<element_type> find_element_type(std::string_view name) noexcept {
    for (const auto& row : detail::element_type_table)
        if (row.name == name)
            return row.type;
    return std::nullopt;
}

/// Arithmetic types that a file can hold bit by bit.
template <class T>
concept storable =
    std::is_same_v<T, float> || std::is_same_v<T, double> || std::is_same_v<T, std::uint8_t> ||
    std::is_same_v<T, std::int8_t> || std::is_same_v<T, std::uint16_t> || std::is_same_v<T, std::int16_t> ||
    std::is_same_v<T, std::uint32_t> || std::is_same_v<T, std::int32_t> || std::is_same_v<T, std::uint64_t> ||
    std::is_same_v<T, std::int64_t>;

/// The element type that has the very representation of the C++ type `T`.
template <storable T>
constexpr element_type element_type_of() noexcept {
    if constexpr (std::is_floating_point_v<T>) {
        return sizeof(T) == 4 ? element_type::float32 : element_type::float64;
    } else {
        constexpr std::array<std::pair<element_type, element_type>, 4> by_width{{
            {element_type::int8, element_type::uint8},
            {element_type::int16, element_type::uint16},
            {element_type::int32, element_type::uint32},
            {element_type::int64, element_type::uint64},
        }};
        constexpr auto row = by_width[static_cast<std::size_t>(std::countr_zero(sizeof(T)))];
        return std::is_signed_v<T> ? row.first : row.second;
    }
}

/// The value of an IEEE 754 binary16 number. Exact; the payload of a NaN is kept.
constexpr float float16_to_float(std::uint16_t bits) noexcept {
    const std::uint32_t sign = static_cast<std::uint32_t>(bits & 0x8000U) << 16;
    const std::uint32_t exponent = (bits >> 10) & 0x1FU;
    const std::uint32_t fraction = bits & 0x3FFU;
    if (exponent == 0x1F)
        return detail::bits_as<float>(sign | 0x7F80'0000U | (fraction << 13));
    if (exponent != 0)
        return detail::bits_as<float>(sign | ((exponent + 112) << 23) | (fraction << 13));
    // Zero and subnormals count in units of 2^-24, and each is a normal number in float32.
    const float magnitude = static_cast<float>(fraction) * 0x1p-24F;
    return sign != 0 ? -magnitude : magnitude;
}

/// The value of a bfloat16 number, the upper half of a float32. Exact.
constexpr float bfloat16_to_float(std::uint16_t bits) noexcept {
    return detail::bits_as<float>(static_cast<std::uint32_t>(bits) << 16);
}

// A 64-bit checksum detects files that have changed since they were written.

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
