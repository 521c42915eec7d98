#pragma once

#include <tactnet/kernels/simd/tile_lines.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

// The transforms of Winograd convolution in one dimension (kernels/simd/tile_lines.hpp) in integers. N = 3
// and 4 have the same points in both; tiles of more outputs take 0, ±1, 2 and ∞ for N = 5, and −2 as well for
// N = 6. The fractions of G are multiplied by their common denominator, so that outputs are `line_scale`
// times too large.
//
// Numbers keep within 16 bits before they are multiplied: transformed bytes are at most 68 × 255 in two
// dimensions, transformed weights 12 × 12 × 127. Sums of their products may exceed 32 bits and then wrap
// around: the outputs are right modulo 2³², and that is enough if they fit (winograd_tiles.hpp).

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels::detail {

/// How many times too large the outputs of a line of N products are.
[[nodiscard]] constexpr std::uint32_t line_scale(std::size_t products) {
    constexpr std::array<std::uint32_t, 4> scales{1, 2, 6, 24};
    return scales[products - 3];
}

/// Row `line` of the scaled G times the taps of a kernel. For N = 6, the output transform applies the factor
/// 24 of the last row: with it, transformed weights would exceed 16 bits.
template <std::size_t N, std::size_t Kernel>
[[nodiscard]] constexpr int integer_kernel_element(std::size_t line, const std::array<int, Kernel>& g) {
    static_assert(N >= 3 && N <= 6 && (Kernel == 2 || Kernel == 3));
    constexpr std::array<int, 4> of_zero{1, 2, 3, 6}, of_one{1, 1, -3, -4}, of_minus_one{0, 1, -1, -4},
        of_infinity{1, 2, 6, 1};
    const int square = Kernel == 3 ? g[Kernel - 1] : 0;
    if (line == 0)
        return of_zero[N - 3] * g[0];
    if (line + 1 == N)
        return of_infinity[N - 3] * g[Kernel - 1];
    if (line == 1)
        return of_one[N - 3] * (g[0] + g[1] + square);
    if (line == 2)
        return of_minus_one[N - 3] * (g[0] - g[1] + square);
    return g[0] + (line == 3 ? 2 : -2) * g[1] + 4 * square;
}

/// The input transform: Bᵀ times a column of d, or a row of d times B.
template <class Vector, std::size_t N>
[[gnu::always_inline]] inline std::array<Vector, N> integer_input_line(const std::array<Vector, N>& d) {
    if constexpr (N <= 4) {
        return tile_input_line(d);
    } else {
        const Vector odd = d[3] - d[1], twice = odd + odd;
        if constexpr (N == 5) {
            const Vector less = d[1] - d[2];
            const Vector even = d[0] - d[2];
            return {odd + even + even, odd - d[1] - d[2], odd + less + less + less, odd, d[4] - d[2] - twice};
        } else {
            const Vector even = d[4] - d[2], far_even = d[4] - (d[2] << 2), far_odd = d[3] - (d[1] << 2);
            return {even + ((d[0] - d[2]) << 2),
                    far_even + far_odd,
                    far_even - far_odd,
                    even + twice,
                    even - twice,
                    d[5] - d[3] - twice - twice};
        }
    }
}

/// The output transform: Aᵀ times a column of products, or a row of products times A. `Vector` is unsigned,
/// since sums may wrap around.
template <std::size_t Outputs, class Vector, std::size_t N>
[[gnu::always_inline]] inline std::array<Vector, Outputs>
integer_output_line(const std::array<Vector, N>& m) {
    if constexpr (N <= 4) {
        return tile_output_line<Outputs>(m);
    } else {
        static_assert(Outputs >= 3 && Outputs < N);
        const Vector sum = m[1] + m[2], less = m[1] - m[2];
        const Vector far_sum = N == 6 ? m[3] + m[4] : m[3], far_less = N == 6 ? m[3] - m[4] : m[3];
        const Vector last = N == 6 ? (m[N - 1] << 4) + (m[N - 1] << 3) : m[N - 1];
        std::array<Vector, Outputs> y;
        y[0] = m[0] + sum + far_sum;
#pragma GCC unroll 4
        for (std::size_t i = 1; i < Outputs; ++i) { // powers of ±1 and ±2
            y[i] = (i % 2 == 1 ? less : sum) + ((i % 2 == 1 ? far_less : far_sum) << static_cast<int>(i));
            if (i + 1 == Outputs)
                y[i] += last;
        }
        return y;
    }
}

}}} // namespace tactnet::kernels::detail
