#pragma once

#include <tactnet/deployment/eight_bit/format.hpp>
#include <tactnet/deployment/export/step_spellings.hpp>

#include <cstdint>

// How the number format of 8 bits is spelled in exported headers.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

template <>
inline constexpr const char* format_name<eight_bit_between<std::uint8_t, std::uint8_t>> =
    "tactnet::eight_bit_between<std::uint8_t, std::uint8_t>";
template <>
inline constexpr const char* format_name<eight_bit_between<std::int16_t, std::uint8_t>> =
    "tactnet::eight_bit_between<std::int16_t, std::uint8_t>";
template <>
inline constexpr const char* format_name<eight_bit_between<std::uint8_t, float>> =
    "tactnet::eight_bit_between<std::uint8_t, float>";
template <>
inline constexpr const char* format_name<eight_bit_between<std::int16_t, float>> =
    "tactnet::eight_bit_between<std::int16_t, float>";

template <>
struct format_header<eight_bit> {
    static constexpr const char* name = "tactnet/deployment/eight_bit/steps.hpp";
};

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet
