#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/row_vector.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/tensor/aligned.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Direct convolution of a map with few weights that are even in both directions, in place: faster than
/// symmetric_convolution for weights that cover some ten cells, and for maps with many empty rows.
///
///     map(y, x) ← max(0, Σ weight(|i|, |j|) map(y + i, x + j)),    |i| ≤ radius.rows, |j| ≤ radius.columns.
///
/// The map is padded with zeros. Negative values and NaN count as zero, infinite values as the largest
/// number. The constructor allocates the workspace. Each thread needs an object of its own.
template <shape Shape>
class symmetric_stencil {
    static constexpr std::size_t width = row_lanes<float>(Shape.columns),
                                 vectors = row_vectors(Shape.columns, width);
    using wide = sized_vector<float, width>;
    // Rows with room for the largest radius on both sides.
    static constexpr std::size_t margin = round_up(Shape.columns, width), row_size = 3 * margin;

public:
    /// `weight(rows, columns)` is the weight at such a distance. A radius beyond the map is reduced.
    template <class Weight>
    symmetric_stencil(extent2d radius, const Weight& weight)
        : radius_(std::min(radius.rows, Shape.rows - 1), std::min(radius.columns, Shape.columns - 1)),
          rows_(Shape.rows * row_size, 0.0f),
          pair_(row_size, 0.0f) {
        for (std::size_t i = 0; i <= radius_.rows; ++i)
            for (std::size_t j = 0; j <= 2 * radius_.columns; ++j)
                weights_.push_back(
                    weight(i, j < radius_.columns ? radius_.columns - j : j - radius_.columns));
    }

    void apply(float* map) noexcept {
        std::array<bool, Shape.rows> empty;
        for (std::size_t y = 0; y < Shape.rows; ++y) {
            float* const row = rows_.data() + y * row_size + margin;
            float largest = 0;
            for (std::size_t x = 0; x < Shape.columns; ++x) {
                const float value = map[y * Shape.columns + x];
                row[x] = value > 0 ? std::min(value, std::numeric_limits<float>::max()) : 0;
                largest = row[x] > largest ? row[x] : largest;
            }
            empty[y] = !(largest > 0);
        }
        for (std::size_t y = 0; y < Shape.rows; ++y)
            blocked<vectors, 8>([&](auto block, std::size_t first) {
                constexpr std::size_t count = block;
                std::array<wide, count> sums;
#pragma GCC unroll 64
                for (std::size_t v = 0; v < count; ++v)
                    sums[v] = wide(0);
                for (std::size_t i = 0; i <= radius_.rows; ++i)
                    if (const float* const row = rows_apart(y, i, empty))
                        add<count>(row, weights_.data() + i * (2 * radius_.columns + 1), first, sums);
#pragma GCC unroll 64
                for (std::size_t v = 0; v < count; ++v)
                    store_in_row<Shape.columns, width>(map + y * Shape.columns +
                                                           row_vector_begin(first + v, Shape.columns, width),
                                                       maximum_or_second(sums[v], wide(0)));
            });
    }

private:
    /// The sum of the rows y − i and y + i, which have the same weights; null if both are empty.
    const float* rows_apart(std::size_t y, std::size_t i, const std::array<bool, Shape.rows>& empty) {
        const bool above = i <= y && !empty[y - i], below = i > 0 && y + i < Shape.rows && !empty[y + i];
        const float* const a = rows_.data() + (above ? y - i : 0) * row_size;
        const float* const b = rows_.data() + (below ? y + i : 0) * row_size;
        if (!above || !below)
            return above ? a : below ? b : nullptr;
        for (std::size_t x = margin; x < 2 * margin; x += width)
            store_as(pair_.data() + x, load_as<wide>(a + x) + load_as<wide>(b + x));
        return pair_.data();
    }
    template <std::size_t Count>
    void add(const float* row, const float* weights, std::size_t first, std::array<wide, Count>& sums) const {
        for (std::size_t j = 0; j <= 2 * radius_.columns; ++j) {
            const float* const from = row + margin + j - radius_.columns;
            const wide weight(weights[j]);
#pragma GCC unroll 64
            for (std::size_t v = 0; v < Count; ++v)
                sums[v] = fused_multiply_add(
                    load_unaligned<wide>(from + row_vector_begin(first + v, Shape.columns, width)), weight,
                    sums[v]);
        }
    }

    extent2d radius_;
    aligned_vector<float> rows_, pair_, weights_;
};

}}} // namespace tactnet::kernels
