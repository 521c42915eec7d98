#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>

// The compiler's own vectors. xsimd has neither the products of bytes that networks in 8 bits are made of,
// nor conversions that give the same result in all its versions, and xsimd 8 exchanges no lanes.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

template <class T, std::size_t Lanes>
struct compiler_vector {
    using type [[gnu::vector_size(sizeof(T) * Lanes)]] = T;
};

} // namespace detail

template <std::size_t Lanes>
using float_vec = typename detail::compiler_vector<float, Lanes>::type;
template <std::size_t Lanes>
using int32_vec = typename detail::compiler_vector<std::int32_t, Lanes>::type;
template <std::size_t Lanes>
using uint32_vec = typename detail::compiler_vector<std::uint32_t, Lanes>::type;
template <std::size_t Lanes>
using int16_vec = typename detail::compiler_vector<std::int16_t, Lanes>::type;
template <std::size_t Lanes>
using uint8_vec = typename detail::compiler_vector<std::uint8_t, Lanes>::type;

/// A pointer that is known to be a multiple of `Bytes`: Clang loads a word byte by byte unless it knows.
template <std::size_t Bytes, class T>
[[nodiscard]] [[gnu::always_inline]] inline T* aligned(T* pointer) {
    return static_cast<T*>(__builtin_assume_aligned(pointer, Bytes));
}
/// Loads from memory that was written as another type, aligned as an element of T.
template <class Vector, class T>
[[nodiscard]] [[gnu::always_inline]] inline Vector load_bytes_as(const T* from) {
    Vector values;
    std::memcpy(static_cast<void*>(&values), from, sizeof(values)); // a class may have initial values
    return values;
}
/// Stores to any alignment.
template <class Vector>
[[gnu::always_inline]] inline void store_any(void* to, const Vector& values) {
    std::memcpy(to, &values, sizeof(values));
}

}}} // namespace tactnet::kernels
