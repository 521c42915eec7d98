#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/simd/row_vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

// Interpolation at positions given by an affine map. Positions and weighted sums are computed in vectors. In
// between, plain loads and stores copy the pixels around each position, which takes a quarter of the time of
// gathers and works on every processor. The image is laid out as pairs of a pixel and the pixel below, so
// that one load takes 2 × 2 or 2 × 4 pixels.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Positions in an image, in pixels from its first: row = row_start + row_by_row · y + row_by_column · x, and
/// the column alike, where x and y count from the centre of the output.
struct affine_positions {
    double row_start, row_by_row, row_by_column, column_start, column_by_row, column_by_column;
};

/// `Rows` × `Columns` outputs, each from `Taps` × `Taps` pixels around its position: 2 interpolates linearly,
/// 4 by Keys' cubic with a = −½. At a whole position in a direction, the result is that pixel alone.
template <std::size_t Rows, std::size_t Columns, std::size_t Taps>
class affine_sampling {
    static_assert(Taps == 2 || Taps == 4);
    static constexpr std::size_t radius = Taps / 2;

public:
    /// Pixels of padding before the first and after the last of the image, in both directions. Positions
    /// beyond half of the padding see padding alone.
    static constexpr std::size_t before = Taps - 1, behind = Taps;
    static constexpr std::size_t stride = Columns + before + behind;
    static constexpr std::size_t padded_rows = Rows + before + behind;

    /// `padded` is an image of the size of the outputs with `before` and `behind` pixels around it, rows
    /// `stride` apart.
    [[gnu::flatten]] static void run(const affine_positions& map, const float* padded, float* to) {
        static_assert(2 * padded_rows * stride < (1u << 24),
                      "positions are whole numbers in single precision");
        buffers memory;
        if constexpr (Rows * Columns < min_lanes<float>) // vectors read past the last position
            memory = {};
        pair_rows(padded, memory.pairs.data());
        blocked<Rows, rows_at_once>([&](auto rows, std::size_t first) {
            for (std::size_t y = 0; y < rows; ++y)
                find_positions(map, first + y, y * Columns, memory);
            copy_pixels<rows * Columns>(memory);
            weigh_pixels<rows * Columns>(memory, to + first * Columns);
        });
    }

private:
    // A few hundred positions: stores have left the store queue before their values are loaded again, and
    // everything stays in the first level of cache.
    static constexpr std::size_t rows_at_once = std::clamp<std::size_t>(384 / Columns, 1, Rows),
                                 positions = rows_at_once * Columns + lanes<float>;

    struct buffers {
        alignas(vector_alignment) std::array<float, 2 * (padded_rows - 1) * stride> pairs;
        alignas(vector_alignment) std::array<std::int32_t, positions> first;
        alignas(vector_alignment) std::array<float, positions> row_rest, column_rest;
        alignas(vector_alignment) std::array<std::array<float, 2 * Taps * positions>, Taps / 2> pixels;
    };

    static constexpr auto from_centre = [] {
        std::array<float, Columns + lanes<float>> all{};
        for (std::size_t x = 0; x < all.size(); ++x)
            all[x] = static_cast<float>(x) - static_cast<float>(Columns - 1) / 2;
        return all;
    }();

    /// Stores, for each position in a row of outputs, the place in `pairs` of its first pixel and the
    /// fractions.
    static void find_positions(const affine_positions& map, std::size_t y, std::size_t at, buffers& memory) {
        constexpr std::size_t width = row_lanes<float>(Columns);
        using wide = sized_vector<float, width>;
        const double v = static_cast<double>(y) - static_cast<double>(Rows - 1) / 2;
        const auto along = [&](double start, double by_row, double by_column, std::size_t size,
                               std::size_t begin) {
            const wide position = fused_multiply_add(wide(static_cast<float>(by_column)),
                                                     load_unaligned<wide>(&from_centre[begin]),
                                                     wide(static_cast<float>(start + by_row * v + radius)));
            return clamp(position, wide(0), wide(static_cast<float>(size - 1 + 2 * radius)));
        };
        for (std::size_t i = 0; i < row_vectors(Columns, width); ++i) {
            const std::size_t begin = row_vector_begin(i, Columns, width);
            const wide row = along(map.row_start, map.row_by_row, map.row_by_column, Rows, begin);
            const wide column =
                along(map.column_start, map.column_by_row, map.column_by_column, Columns, begin);
            const wide top = truncate(row), left = truncate(column);
            store_anywhere(&memory.row_rest[at + begin], row - top);
            store_anywhere(&memory.column_rest[at + begin], column - left);
            store_int32(&memory.first[at + begin],
                        fused_multiply_add(top, wide(static_cast<float>(2 * stride)), left + left));
        }
    }

    /// Interleaves each pixel with the one below it.
    static void pair_rows(const float* padded, float* pairs) {
        constexpr std::size_t count = (padded_rows - 1) * stride, width = lanes_for<float>(count);
        using wide = sized_vector<float, width>;
        for (std::size_t v = 0; v < row_vectors(count, width); ++v) {
            const std::size_t begin = row_vector_begin(v, count, width);
            const auto both = interleave(load_unaligned<wide>(padded + begin),
                                         load_unaligned<wide>(padded + begin + stride));
            store_anywhere(pairs + 2 * begin, both[0]);
            store_anywhere(pairs + 2 * begin + width, both[1]);
        }
    }

    template <std::size_t Count>
    static void copy_pixels(buffers& memory) {
        blocked<Count, 8>([&](auto count, std::size_t begin) {
            constexpr std::size_t some = count;
#pragma GCC unroll 64
            for (std::size_t i = 0; i < some; ++i) {
                const float* const first = memory.pairs.data() + memory.first[begin + i];
#pragma GCC unroll 64
                for (std::size_t pair = 0; pair < radius; ++pair)
                    std::memcpy(&memory.pixels[pair][2 * Taps * (begin + i)], first + 4 * pair * stride,
                                2 * Taps * sizeof(float));
            }
        });
    }

    template <std::size_t Count>
    static void weigh_pixels(const buffers& memory, float* to) {
        constexpr std::size_t width = lanes_for<float>(Count);
        using wide = sized_vector<float, width>;
        for (std::size_t v = 0; v < row_vectors(Count, width); ++v) {
            const std::size_t begin = row_vector_begin(v, Count, width);
            const weights<wide> along(load_unaligned<wide>(&memory.column_rest[begin])),
                down(load_unaligned<wide>(&memory.row_rest[begin]));
            std::array<wide, Taps> rows;
#pragma GCC unroll 64
            for (std::size_t pair = 0; pair < radius; ++pair) {
                std::array<wide, 2 * Taps> pixels;
#pragma GCC unroll 64
                for (std::size_t i = 0; i < 2 * Taps; ++i)
                    pixels[i] = load_unaligned<wide>(&memory.pixels[pair][2 * Taps * begin + i * width]);
                pixels = deinterleave(pixels);
                std::array<wide, Taps> upper, lower;
#pragma GCC unroll 64
                for (std::size_t i = 0; i < Taps; ++i)
                    upper[i] = pixels[2 * i], lower[i] = pixels[2 * i + 1];
                rows[2 * pair] = along(upper), rows[2 * pair + 1] = along(lower);
            }
            store_in_row<Count, width>(to + begin, down(rows));
        }
    }

    /// Interpolation weights at a fraction `rest` between two pixels.
    template <class Vector>
    struct weights {
        Vector rest;
        std::array<Vector, Taps> of;

        explicit weights(const Vector& t) : rest(t) {
            if constexpr (Taps == 4) {
                const Vector half(0.5f), one(1), u = one - t;
                of[0] = (Vector(0) - half) * t * u * u;
                of[1] = fused_multiply_add(fused_multiply_add(Vector(1.5f), t, Vector(-2.5f)), t * t, one);
                of[2] = fused_multiply_add(fused_multiply_add(Vector(1.5f), u, Vector(-2.5f)), u * u, one);
                of[3] = (Vector(0) - half) * u * t * t;
            }
        }
        [[nodiscard]] Vector operator()(const std::array<Vector, Taps>& pixels) const {
            if constexpr (Taps == 2) {
                return select_if_zero(rest, pixels[0],
                                      fused_multiply_add(rest, pixels[1] - pixels[0], pixels[0]));
            } else {
                Vector sum(0);
#pragma GCC unroll 4
                for (std::size_t i = 0; i < 4; ++i)
                    sum = fused_multiply_add(pixels[i], of[i], sum);
                return select_if_zero(rest, pixels[1], sum);
            }
        }
    };
};

}}} // namespace tactnet::kernels
