#pragma once

#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cstddef>

// Transforms of Winograd's convolutions F(2 × 2, 3 × 3) and F(4 × 4, 3 × 3) (Winograd, 1980; Lavin and Gray,
// 2016): y = Aᵀ [(G g Gᵀ) ∘ (Bᵀ d B)] A, with d the input tile, g the kernel, y the outputs.
// frame/winograd_tiles.hpp has the factors of F(2 × 2). Those of F(4 × 4) interpolate at 0, ±1/√2, ±√2 and
// infinity instead of at whole numbers: no factor is larger than 2√2, and errors become a fifth (Barabasz et
// al., "Error analysis and improving the accuracy of Winograd convolution", 2020, on the choice of points).
//
// clang-format off
//   Bᵀ = 1   0  −5/2   0    1  0     G = 1     0     0     Aᵀ = 1   1     1    1    1   0
//        0  −√2  −2   √2/2  1  0        −2/3 −√2/3 −1/3         0  √2/2 −√2/2  √2  −√2  0
//        0   √2  −2  −√2/2  1  0        −2/3  √2/3 −1/3         0   ½     ½    2    2   0
//        0 −√2/2 −½    √2   1  0         1/6  √2/6  1/3         0  √2/4 −√2/4 2√2 −2√2  1
//        0  √2/2 −½   −√2   1  0         1/6 −√2/6  1/3
//        0   1    0  −5/2   0  1         0     0     1
// clang-format on

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

namespace detail {

inline constexpr double root_of_two = 1.41421356237309504880;

/// Bᵀ times a column of d, or a row of d times B; of a tile of 2 × 2 outputs and of 4 × 4.
template <class Vector>
[[gnu::always_inline]] inline std::array<Vector, 4> tile_input_line(const std::array<Vector, 4>& d) {
    return {d[0] - d[2], d[1] + d[2], d[2] - d[1], d[1] - d[3]};
}
template <class Vector>
[[gnu::always_inline]] inline std::array<Vector, 6> tile_input_line(const std::array<Vector, 6>& d) {
    const auto times = [](double factor, const Vector& x, const Vector& y) __attribute__((always_inline)) {
        return fused_multiply_add(Vector(static_cast<float>(factor)), x, y);
    };
    const auto half_root = Vector(static_cast<float>(root_of_two / 2));
    const Vector even1 = times(-2, d[2], d[4]), odd1 = times(-root_of_two, d[1], half_root * d[3]);
    const Vector even2 = times(-0.5, d[2], d[4]),
                 odd2 = times(root_of_two, d[3], half_root * (Vector(0.0f) - d[1]));
    return {times(-2.5, d[2], d[0] + d[4]), even1 + odd1, even1 - odd1, even2 + odd2, even2 - odd2,
            times(-2.5, d[3], d[1] + d[5])};
}
/// Aᵀ times a column of products, or a row of them times A.
template <class Vector>
[[gnu::always_inline]] inline std::array<Vector, 2> tile_output_line(const std::array<Vector, 4>& m) {
    return {m[0] + m[1] + m[2], m[1] - m[2] - m[3]};
}
template <class Vector>
[[gnu::always_inline]] inline std::array<Vector, 4> tile_output_line(const std::array<Vector, 6>& m) {
    const auto times = [](double factor, const Vector& x) __attribute__((always_inline)) {
        return Vector(static_cast<float>(factor)) * x;
    };
    const auto and_times =
        [](double factor, const Vector& x, const Vector& y) __attribute__((always_inline)) {
        return fused_multiply_add(Vector(static_cast<float>(factor)), x, y);
    };
    const Vector sum1 = m[1] + m[2], less1 = m[1] - m[2], sum2 = m[3] + m[4], less2 = m[3] - m[4];
    return {m[0] + sum1 + sum2, and_times(root_of_two, less2, times(root_of_two / 2, less1)),
            and_times(2, sum2, times(0.5, sum1)),
            and_times(2 * root_of_two, less2, and_times(root_of_two / 4, less1, m[5]))};
}
/// Element `line` of G times three numbers.
template <std::size_t Outputs>
[[nodiscard]] constexpr double tile_kernel_line(std::size_t line, double a, double b, double c) {
    const double sign = line % 2 == 1 ? 1 : -1;
    if (line == 0)
        return a;
    if (line == Outputs + 1)
        return c;
    if constexpr (Outputs == 2)
        return 0.5 * (a + sign * b + c);
    else
        return line < 3 ? -(2 * a + sign * root_of_two * b + c) / 3
                        : (a + sign * root_of_two * b + 2 * c) / 6;
}

} // namespace detail

/// to[element][channel] = Bᵀ d B of one tile, whole vectors of channels. Distances in elements.
template <std::size_t Outputs>
[[gnu::flatten, gnu::noinline]] void transform_tile(const float* from, std::size_t row_distance,
                                                    std::size_t pixel_distance, std::size_t channels,
                                                    float* to, std::size_t element_distance) {
    constexpr std::size_t side = Outputs + 2;
    using wide = vector<float>;
    for (std::size_t channel = 0; channel < channels; channel += lanes<float>) {
        std::array<std::array<wide, side>, side> d;
#pragma GCC unroll 64
        for (std::size_t x = 0; x < side; ++x) {
            std::array<wide, side> column;
#pragma GCC unroll 64
            for (std::size_t y = 0; y < side; ++y)
                column[y] = load_as<wide>(from + y * row_distance + x * pixel_distance + channel);
            column = detail::tile_input_line(column);
#pragma GCC unroll 64
            for (std::size_t y = 0; y < side; ++y)
                d[y][x] = column[y];
        }
#pragma GCC unroll 64
        for (std::size_t y = 0; y < side; ++y) {
            const std::array<wide, side> line = detail::tile_input_line(d[y]);
#pragma GCC unroll 64
            for (std::size_t x = 0; x < side; ++x)
                store_as(to + (y * side + x) * element_distance + channel, line[x]);
        }
    }
}

/// Where the outputs of one tile go, and what becomes of them.
struct tile_outputs {
    float* output;
    std::size_t row_distance, pixel_distance; ///< elements
    extent size;                              ///< outputs that are in the image, before a pool
    bool adds, rectified;
    bool pooled; ///< by a max pool of 2 × 2
};

/// Aᵀ m A + bias, the other term of a sum, max pool, ReLU, of the filters [first, last).
template <std::size_t Outputs>
[[gnu::flatten, gnu::noinline]] void transform_tile_back(const float* products, std::size_t element_distance,
                                                         const float* bias, std::size_t first,
                                                         std::size_t last, const tile_outputs& to) {
    constexpr std::size_t side = Outputs + 2, all = Outputs * Outputs;
    using wide = vector<float>;
    const auto finished = [&](const wide& value) __attribute__((always_inline)) {
        return to.rectified ? maximum_or_second(wide(0.0f), value) : value;
    };
    for (std::size_t f = first; f < last; f += lanes<float>) {
        std::array<std::array<wide, side>, Outputs> half;
#pragma GCC unroll 64
        for (std::size_t x = 0; x < side; ++x) {
            std::array<wide, side> column;
#pragma GCC unroll 64
            for (std::size_t y = 0; y < side; ++y)
                column[y] = load_as<wide>(products + (y * side + x) * element_distance + f);
            const std::array<wide, Outputs> sums = detail::tile_output_line(column);
#pragma GCC unroll 64
            for (std::size_t y = 0; y < Outputs; ++y)
                half[y][x] = sums[y];
        }
        const wide start = load_as<wide>(bias + f);
        std::array<wide, all> values;
#pragma GCC unroll 64
        for (std::size_t y = 0; y < Outputs; ++y) {
            const std::array<wide, Outputs> line = detail::tile_output_line(half[y]);
#pragma GCC unroll 64
            for (std::size_t x = 0; x < Outputs; ++x)
                values[y * Outputs + x] = line[x] + start;
        }
        if (to.pooled) {
#pragma GCC unroll 64
            for (std::size_t i = 0; i < all / 4; ++i) {
                const std::size_t y = i / (Outputs / 2) * 2, x = i % (Outputs / 2) * 2;
                if (y >= to.size.rows || x >= to.size.columns)
                    continue;
                const bool below = y + 1 < to.size.rows, right = x + 1 < to.size.columns;
                wide largest = values[y * Outputs + x];
                if (right)
                    largest = maximum_or_second(values[y * Outputs + x + 1], largest);
                if (below)
                    largest = maximum_or_second(values[(y + 1) * Outputs + x], largest);
                if (below && right)
                    largest = maximum_or_second(values[(y + 1) * Outputs + x + 1], largest);
                store_as(to.output + y / 2 * to.row_distance + x / 2 * to.pixel_distance + f,
                         finished(largest));
            }
        } else {
#pragma GCC unroll 64
            for (std::size_t i = 0; i < all; ++i) {
                if (i / Outputs >= to.size.rows || i % Outputs >= to.size.columns)
                    continue;
                float* const place =
                    to.output + i / Outputs * to.row_distance + i % Outputs * to.pixel_distance + f;
                store_as(place, finished(to.adds ? values[i] + load_as<wide>(place) : values[i]));
            }
        }
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
