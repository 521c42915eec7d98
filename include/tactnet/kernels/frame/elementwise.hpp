#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/kernels/norms.hpp>
#include <tactnet/kernels/simd/row_vector.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

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

// Operations on one frame, element by element or pixel by pixel: normalisation of its counts, square roots,
// slopes below zero, local response normalisation.

/// to[i] = (counts[i] − mean[i]) × scale for `Size` counts in bytes or floats, of any alignment. Returns
/// whether all results are finite and within ± limit; for bytes the caller chooses the limit so that they
/// are. Written in vectors because compilers leave a plain loop scalar in some callers, where it then takes
/// as long as a layer.
template <std::size_t Size, class Count>
[[nodiscard]] inline bool normalise_counts(const Count* counts, const float* mean, float scale, float limit,
                                           float* to) {
    constexpr std::size_t width = lanes_for<float>(Size);
    constexpr bool always_in_range = !std::is_floating_point_v<Count>;
    if constexpr (Size < width) {
        bool in_range = true;
        for (std::size_t i = 0; i < Size; ++i) {
            to[i] = (static_cast<float>(counts[i]) - mean[i]) * scale;
            in_range = in_range && (always_in_range || (to[i] <= limit && to[i] >= -limit));
        }
        return in_range;
    } else {
        using wide = sized_vector<float, width>;
        wide beyond(0.0f);
        for (std::size_t v = 0; v < row_vectors(Size, width); ++v) {
            const std::size_t at = row_vector_begin(v, Size, width);
            const wide number =
                (load_floats<wide>(counts + at) - load_unaligned<wide>(mean + at)) * wide(scale);
            store_anywhere(to + at, number);
            // The difference is 0 within the limits, infinite for an infinity and NaN for NaN.
            if constexpr (!always_in_range)
                beyond = select_if_zero(clamp(number, wide(-limit), wide(limit)) - number, beyond,
                                        wide(std::numeric_limits<float>::infinity()));
        }
        return all_finite(beyond);
    }
}

/// output[i] = operation(input[i]) for `Count` elements, vector by vector. Both maps are aligned.
template <std::size_t Count>
void transform_map(auto&& operation, const float* input, float* output) {
    constexpr std::size_t whole = Count / lanes<float> * lanes<float>;
    transform_vectors(operation, whole, output, input);
    if constexpr (whole < Count) {
        alignas(vector_alignment) std::array<float, lanes<float>> rest{};
        std::copy_n(input + whole, Count - whole, rest.begin());
        transform_vectors(operation, lanes<float>, rest.data(), std::as_const(rest).data());
        std::copy_n(rest.begin(), Count - whole, output + whole);
    }
}

/// output = x above 0, otherwise x × the slope of its channel, rounded once. `Stride` elements from one pixel
/// to the next, in both maps, and slopes.
template <std::size_t Stride>
void scale_negative(std::size_t pixels, const float* slopes, const float* input, float* output) {
    using wide = typename decltype(pixel_vector<float, Stride>())::type;
    using access = pixel_access<wide>;
    constexpr std::size_t width = sizeof(wide) / sizeof(float);
    for (std::size_t p = 0; p < pixels; ++p, input += Stride, output += Stride)
        for (std::size_t c = 0; c < Stride; c += width) {
            const wide x = access::load(input + c), above = access::larger(wide(0.0f), x);
            access::store(output + c, fused_multiply_add(access::load(slopes + c), x - above, above));
        }
}

/// Local response normalisation along the channels of each pixel, `Stride` elements from one pixel to the
/// next, in both maps. Zeros after the last channel stay zeros.
template <class Rule, std::size_t Stride>
void normalise_pixels(std::size_t pixels, const float* input, float* output) {
    constexpr std::size_t room = padded_size<float>(Stride);
    std::array<float, room + Rule::size> squares{};
    alignas(vector_alignment) std::array<float, room> values{}, sums;
    const vector<float> share(static_cast<float>(Rule::share)), k(static_cast<float>(Rule::k));
    for (std::size_t p = 0; p < pixels; ++p, input += Stride, output += Stride) {
        for (std::size_t c = 0; c < Stride; ++c)
            squares[Rule::before + c] = input[c] * input[c];
        std::copy_n(input, Stride, values.begin());
        for (std::size_t c = 0; c < room; ++c) {
            float sum = squares[c];
            for (std::size_t i = 1; i < Rule::size; ++i)
                sum += squares[c + i];
            sums[c] = sum;
        }
        for (std::size_t c = 0; c < room; c += lanes<float>)
            store(values.data() + c,
                  load(values.data() + c) *
                      Rule::template power<float>(multiply_add<float>(load(sums.data() + c), share, k)));
        std::copy_n(values.begin(), Stride, output);
    }
}

}}} // namespace tactnet::kernels
