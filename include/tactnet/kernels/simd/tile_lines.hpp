#pragma once

#include <tactnet/kernels/simd/vector.hpp>

#include <array>
#include <cstddef>

// The transforms of Winograd convolution in one dimension (Winograd, 1980; Lavin and Gray, 2016): M outputs
// of a kernel of K taps take N = M + K − 1 products instead of M K. With the input d, the kernel g and the
// outputs y: y = Aᵀ [(G g) ∘ (Bᵀ d)]. A tile in two dimensions applies one transform to its rows and one to
// its columns, which may have different sizes.
//
// The N products are the values of polynomials at N − 1 points and at infinity. B depends on N alone; row j
// of G holds the powers of point j times a factor, column j of A the powers of point j. The last row of G and
// the last column of A, for infinity, are 0 except for their last element: 1 in G; in A −1 for N = 3 and 4, 1
// for 5 and 6.
//
//   N   points                    M, K              factors of G
//   3   0, 1                      2, 2              1, 1
//   4   0, ±1                     2, 3 and 3, 2     1, ½, ½
//   5   ±√½, ±√2                  3, 3 and 4, 2     ∓√2/3, ±√2/6
//   6   0, ±√½, ±√2               4, 3 and 5, 2     1, −2/3, −2/3, 1/6, 1/6
//
// The points ±√½ and ±√2 instead of integers keep the factors small and reduce errors to a fifth (Barabasz et
// al., "Error analysis and improving the accuracy of Winograd convolution", 2020, on the choice of points).
//
// clang-format off
//   N = 3:  Bᵀ = 1 −1  0     N = 4:  Bᵀ = 1  0 −1  0     N = 5:  Bᵀ = −√2  −2   √2/2  1  0
//                0  1  0                  0  1  1  0                   √2  −2  −√2/2  1  0
//                0  1 −1                  0 −1  1  0                 −√2/2 −½    √2   1  0
//                                         0  1  0 −1                  √2/2 −½   −√2   1  0
//                                                                      1    0  −5/2   0  1
//   N = 6:  the first four rows of N = 5 shifted right by one, between 1 0 −5/2 0 1 0 and 0 1 0 −5/2 0 1.
// clang-format on

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels::detail {

inline constexpr double root_of_two = 1.41421356237309504880;

template <class Vector>
[[gnu::always_inline]] inline Vector broadcast(double number) {
    return Vector(static_cast<typename Vector::value_type>(number));
}
template <class Vector>
[[gnu::always_inline]] inline Vector times(double factor, const Vector& x) {
    return broadcast<Vector>(factor) * x;
}
/// factor · x + y, rounded once.
template <class Vector>
[[gnu::always_inline]] inline Vector times_and(double factor, const Vector& x, const Vector& y) {
    return fused_multiply_add(broadcast<Vector>(factor), x, y);
}

/// The input transform: Bᵀ times a column of d, or a row of d times B.
template <class Vector, std::size_t N>
[[gnu::always_inline]] inline std::array<Vector, N> tile_input_line(const std::array<Vector, N>& d) {
    static_assert(N >= 3 && N <= 6);
    if constexpr (N == 3) {
        return {d[0] - d[1], d[1], d[1] - d[2]};
    } else if constexpr (N == 4) {
        return {d[0] - d[2], d[1] + d[2], d[2] - d[1], d[1] - d[3]};
    } else {
        // No array of temporaries: GCC 12 would copy it through memory, in vectors of another width.
        constexpr std::size_t first = N - 5;
        const auto half_root = broadcast<Vector>(root_of_two / 2);
        const Vector &d0 = d[first], &d1 = d[first + 1], &d2 = d[first + 2], &d3 = d[first + 3];
        const Vector odd1 = times_and(-2.0, d1, d3), even1 = times_and(-root_of_two, d0, half_root * d2);
        const Vector odd2 = times_and(-0.5, d1, d3),
                     even2 = times_and(root_of_two, d2, half_root * (broadcast<Vector>(0) - d0));
        const Vector last = times_and(-2.5, d2, d0 + d[N - 1]);
        if constexpr (N == 5)
            return {odd1 + even1, odd1 - even1, odd2 + even2, odd2 - even2, last};
        else
            return {times_and(-2.5, d[2], d[0] + d[4]),
                    odd1 + even1,
                    odd1 - even1,
                    odd2 + even2,
                    odd2 - even2,
                    last};
    }
}

/// The output transform: Aᵀ times a column of products, or a row of products times A.
template <std::size_t Outputs, class Vector, std::size_t N>
[[gnu::always_inline]] inline std::array<Vector, Outputs> tile_output_line(const std::array<Vector, N>& m) {
    std::array<Vector, Outputs> y;
    if constexpr (N == 3) {
        static_assert(Outputs == 2);
        y = {m[0] + m[1], m[1] - m[2]};
    } else if constexpr (N == 4) {
        static_assert(Outputs == 2 || Outputs == 3);
        y[0] = m[0] + m[1] + m[2];
        if constexpr (Outputs == 2)
            y[1] = m[1] - m[2] - m[3];
        else
            y = {y[0], m[1] - m[2], m[1] + m[2] - m[3]};
    } else {
        static_assert(Outputs >= 3 && Outputs < N);
        constexpr std::size_t first = N - 5;
        const Vector sum1 = m[first] + m[first + 1], less1 = m[first] - m[first + 1],
                     sum2 = m[first + 2] + m[first + 3], less2 = m[first + 2] - m[first + 3];
        y[0] = first > 0 ? m[0] + sum1 + sum2 : sum1 + sum2;
        // Powers of √½ and √2.
        constexpr std::array<double, 5> small{1, root_of_two / 2, 0.5, root_of_two / 4, 0.25},
            large{1, root_of_two, 2, 2 * root_of_two, 4};
#pragma GCC unroll 4
        for (std::size_t i = 1; i < Outputs; ++i) {
            const Vector &near = i % 2 == 1 ? less1 : sum1, &far = i % 2 == 1 ? less2 : sum2;
            const Vector part =
                i + 1 == Outputs ? times_and(small[i], near, m[N - 1]) : times(small[i], near);
            y[i] = times_and(large[i], far, part);
        }
    }
    return y;
}

/// The transform of the output gradient, the transpose of tile_output_line: A times a column, or a row times
/// Aᵀ.
template <std::size_t N, class Vector, std::size_t Outputs>
[[gnu::always_inline]] inline std::array<Vector, N> tile_gradient_line(const std::array<Vector, Outputs>& y) {
    const auto none = broadcast<Vector>(0);
    if constexpr (N == 3) {
        static_assert(Outputs == 2);
        return {y[0], y[0] + y[1], none - y[1]};
    } else if constexpr (N == 4) {
        static_assert(Outputs == 2 || Outputs == 3);
        const Vector even = Outputs == 2 ? y[0] : y[0] + y[2 % Outputs];
        return {y[0], even + y[1], even - y[1], none - y[Outputs - 1]};
    } else {
        static_assert(Outputs >= 3 && Outputs < N);
        // The even part y₀ + y₂ x² + y₄ x⁴ and the odd part y₁ + y₃ x², to be multiplied by x, at √½ and √2.
        Vector even1 = times_and(0.5, y[2], y[0]), even2 = times_and(2, y[2], y[0]);
        if constexpr (Outputs > 4) {
            even1 = times_and(0.25, y[4], even1);
            even2 = times_and(4, y[4], even2);
        }
        Vector odd1 = y[1], odd2 = y[1];
        if constexpr (Outputs > 3) {
            odd1 = times_and(0.5, y[3], y[1]);
            odd2 = times_and(2, y[3], y[1]);
        }
        constexpr double near = root_of_two / 2, far = root_of_two;
        const Vector line1 = times_and(near, odd1, even1), line2 = times_and(-near, odd1, even1),
                     line3 = times_and(far, odd2, even2), line4 = times_and(-far, odd2, even2);
        if constexpr (N == 5)
            return {line1, line2, line3, line4, y[Outputs - 1]};
        else
            return {y[0], line1, line2, line3, line4, y[Outputs - 1]};
    }
}

/// `tile_input_line` as an argument.
struct tile_input_lines {
    [[gnu::always_inline]] auto operator()(const auto& d) const { return tile_input_line(d); }
};
/// Calls store(row, column, element) for each element of Bᵀ d B; load(row, column) returns the elements of d,
/// and `transform` the transform of a line.
template <class Vector, std::size_t Rows, std::size_t Columns, class Load, class Store,
          class Lines = tile_input_lines>
[[gnu::always_inline]] inline void transform_tile_input(Load&& load, Store&& store, Lines transform = {}) {
    std::array<std::array<Vector, Columns>, Rows> d;
#pragma GCC unroll 64
    for (std::size_t x = 0; x < Columns; ++x) {
        std::array<Vector, Rows> column;
#pragma GCC unroll 64
        for (std::size_t y = 0; y < Rows; ++y)
            column[y] = load(y, x);
        const std::array<Vector, Rows> line = transform(column);
#pragma GCC unroll 64
        for (std::size_t y = 0; y < Rows; ++y)
            d[y][x] = line[y];
    }
#pragma GCC unroll 64
    for (std::size_t y = 0; y < Rows; ++y) {
        const std::array<Vector, Columns> line = transform(d[y]);
#pragma GCC unroll 64
        for (std::size_t x = 0; x < Columns; ++x)
            store(y, x, line[x]);
    }
}

/// The kernel transform: G times the taps of a kernel, in double; scalars, or one kernel per lane. Without
/// loops, since compilers limit the steps of a constant evaluation.
template <std::size_t N, class Number, std::size_t Kernel>
[[nodiscard]] constexpr std::array<Number, N> tile_kernel_line(const std::array<Number, Kernel>& g) {
    static_assert(Kernel == 2 || Kernel == 3);
    const Number c = Kernel == 3 ? g[Kernel - 1] : Number(0.0), last = g[Kernel - 1];
    const Number half(0.5), root(root_of_two);
    if constexpr (N == 3) {
        return {g[0], g[0] + g[1], last};
    } else if constexpr (N == 4) {
        return {g[0], half * (g[0] + g[1] + c), half * (g[0] - g[1] + c), last};
    } else {
        const Number two(2.0), odd = root * g[1];
        const Number near1 = two * g[0] + odd + c, near2 = two * g[0] - odd + c, far1 = g[0] + odd + two * c,
                     far2 = g[0] - odd + two * c;
        if constexpr (N == 6) {
            const Number sixth(1.0 / 6), less(-1.0 / 3);
            return {g[0], less * near1, less * near2, sixth * far1, sixth * far2, last};
        } else { // the products of the differences of points are ∓3 √½ and ±3 √2
            const Number factor(1 / (3 * root_of_two)), less(-1 / (3 * root_of_two));
            return {less * near1, factor * near2, factor * far1, less * far2, last};
        }
    }
}

/// The transform of weight gradients, the transpose of tile_kernel_line: Gᵀ times a column of sums, or a row
/// times G.
template <std::size_t Kernel, class Number, std::size_t N>
[[nodiscard]] [[gnu::always_inline]] inline std::array<Number, Kernel>
tile_weight_line(const std::array<Number, N>& t) {
    static_assert(Kernel == 2 || Kernel == 3);
    std::array<Number, Kernel> g;
    if constexpr (N == 3) {
        g = {t[0] + t[1], t[1] + t[2]};
    } else if constexpr (N == 4) {
        const Number half(0.5), sum = half * (t[1] + t[2]); // halves are exact
        g[0] = t[0] + sum;
        g[1] = half * (t[1] - t[2]);
        g[Kernel - 1] = (Kernel == 3 ? sum : g[1]) + t[3];
    } else {
        // Sums and differences of the values at ±√½ and at ±√2, before their factors.
        constexpr std::size_t first = N - 5;
        const Number near_sum = t[first] + t[first + 1], near_less = t[first] - t[first + 1],
                     far_sum = t[first + 2] + t[first + 3], far_less = t[first + 2] - t[first + 3];
        // For N = 6 the factors of both signs are equal, for N = 5 opposite.
        const Number &near_even = N == 6 ? near_sum : near_less, &near_odd = N == 6 ? near_less : near_sum,
                     &far_even = N == 6 ? far_sum : far_less, &far_odd = N == 6 ? far_less : far_sum;
        constexpr double near = N == 6 ? -1.0 / 3 : -1 / (3 * root_of_two),
                         far = N == 6 ? 1.0 / 6 : 1 / (3 * root_of_two);
        const auto both = [&](double of_near, const Number& x, double of_far, const Number& y) {
            return fused_multiply_add(Number(of_near), x, Number(of_far) * y);
        };
        g[0] = both(2 * near, near_even, far, far_even);
        if (N == 6)
            g[0] = t[0] + g[0];
        g[1] = both(root_of_two * near, near_odd, root_of_two * far, far_odd);
        g[Kernel - 1] = (Kernel == 3 ? both(near, near_even, 2 * far, far_even) : g[1]) + t[N - 1];
    }
    return g;
}

}}} // namespace tactnet::kernels::detail
