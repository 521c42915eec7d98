#pragma once

#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>

#include <cstddef>
#include <cstdint>
#include <type_traits>

// Vectors of the channels of a frame that lies pixel by pixel, in floats or bytes.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The widest vector that divides the elements of a pixel; a number by itself where none does.
template <class T, std::size_t Stride>
[[nodiscard]] constexpr auto pixel_vector() {
    if constexpr (std::is_same_v<T, std::uint8_t>) {
        return std::type_identity<uint8_vec<widest_bytes(Stride)>>{};
    } else if constexpr (Stride % min_lanes<float> != 0) {
        return std::type_identity<float>{};
    } else {
        constexpr std::size_t width = [] {
            std::size_t w = lanes<float>;
            while (Stride % w != 0)
                w /= 2;
            return w;
        }();
        return std::type_identity<sized_vector<float, width>>{};
    }
}

/// Loads, stores and compares pixels as `Vector`, which may be float.
template <class Vector>
struct pixel_access {
    static constexpr bool simd = requires(const float* from) { Vector::load_aligned(from); };

    template <class T>
    [[gnu::always_inline]] static Vector load(const T* from) {
        if constexpr (simd)
            return load_as<Vector>(from);
        else
            return load_bytes_as<Vector>(from);
    }
    template <class T>
    [[gnu::always_inline]] static void store(T* to, const Vector& value) {
        if constexpr (simd)
            store_as(to, value);
        else
            store_any(to, value);
    }
    [[gnu::always_inline]] static Vector larger(const Vector& a, const Vector& b) {
        if constexpr (simd)
            return maximum_or_second(a, b);
        else
            return a > b ? a : b;
    }
};

}}} // namespace tactnet::kernels
