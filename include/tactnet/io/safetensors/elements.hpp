#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/element_type.hpp>
#include <tactnet/io/safetensors/header.hpp>

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

// Converts the bytes of a file to numbers.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <class Stored, class T, class Conversion>
[[gnu::cold, gnu::noinline]] void convert_each(std::span<const std::byte> stored, std::span<T> to,
                                               Conversion conversion) {
    for (std::size_t i = 0; i < to.size(); ++i) {
        Stored value;
        std::memcpy(&value, stored.data() + i * sizeof(Stored), sizeof(Stored));
        to[i] = conversion(value);
    }
}

/// Throws for a finite value beyond the range of T. Infinity and NaN, which every T has, pass.
template <class T>
T narrowed(double value, const std::string& file, std::string_view tensor) {
    if (std::isfinite(value) && std::abs(value) > static_cast<double>(std::numeric_limits<T>::max()))
        throw_tensor_error(file, tensor, {"values within the range of 32-bit numbers"},
                           {std::to_string(value)});
    return static_cast<T>(value);
}

} // namespace detail

/// Converts elements of type `from`, stored with any alignment, to numbers. Any element type converts to
/// float and double: exactly where that is possible, else to the nearest value; float64 values beyond the
/// range of float are an error. An integer type must be the stored type. NaN and infinity pass, for the
/// caller to judge. `file` and `tensor` name the place in errors. Throws file_error.
template <storable T>
void convert_elements(element_type from, std::span<const std::byte> stored, std::span<T> to,
                      const std::string& file, std::string_view tensor) {
    if (from == element_type_of<T>()) {
        // The pointer of an empty span may be null.
        if (!to.empty())
            std::memcpy(to.data(), stored.data(), to.size_bytes());
        return;
    }
    if constexpr (std::floating_point<T>) {
        const auto cast = [](auto value) { return static_cast<T>(value); };
        switch (from) {
        case element_type::boolean:
            return detail::convert_each<std::uint8_t>(stored, to,
                                                      [](std::uint8_t value) { return T(value != 0); });
        case element_type::uint8:
            return detail::convert_each<std::uint8_t>(stored, to, cast);
        case element_type::int8:
            return detail::convert_each<std::int8_t>(stored, to, cast);
        case element_type::int16:
            return detail::convert_each<std::int16_t>(stored, to, cast);
        case element_type::uint16:
            return detail::convert_each<std::uint16_t>(stored, to, cast);
        case element_type::float16:
            return detail::convert_each<std::uint16_t>(
                stored, to, [](std::uint16_t bits) { return T(float16_to_float(bits)); });
        case element_type::bfloat16:
            return detail::convert_each<std::uint16_t>(
                stored, to, [](std::uint16_t bits) { return T(bfloat16_to_float(bits)); });
        case element_type::int32:
            return detail::convert_each<std::int32_t>(stored, to, cast);
        case element_type::uint32:
            return detail::convert_each<std::uint32_t>(stored, to, cast);
        case element_type::float32:
            return detail::convert_each<float>(stored, to, cast);
        case element_type::float64:
            return detail::convert_each<double>(
                stored, to, [&](double value) { return detail::narrowed<T>(value, file, tensor); });
        case element_type::int64:
            return detail::convert_each<std::int64_t>(stored, to, cast);
        case element_type::uint64:
            return detail::convert_each<std::uint64_t>(stored, to, cast);
        }
        throw std::logic_error("tactnet: an element type that does not exist");
    } else {
        detail::throw_tensor_error(file, tensor, {"element type ", element_type_name(element_type_of<T>())},
                                   {element_type_name(from)});
    }
}

}} // namespace tactnet
