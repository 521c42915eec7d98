#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/map/hartley.hpp>
#include <tactnet/kernels/simd/row_vector.hpp>
#include <tactnet/kernels/simd/vector.hpp>
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

/// Convolution of a map with a kernel that is as large as the map and even in both directions, such as an
/// influence that depends on distance:
///
///     to(y, x) = Σ kernel(|y − y'|, |x − x'|) from(y', x').
///
/// The map is padded with zeros, so that nothing wraps around. Maps are of double, aligned, with rows
/// `stride` apart, and zero between the last column and the next row. The constructor allocates the
/// workspace; a convolution allocates nothing. Each thread needs an object of its own.
template <shape Shape>
class symmetric_convolution {
    static constexpr std::size_t power_of_two(std::size_t least) {
        std::size_t power = 4;
        while (power < least)
            power *= 2;
        return power;
    }
    static constexpr std::size_t width = lanes<double>;
    static constexpr std::size_t tall = power_of_two(2 * Shape.rows - 1),
                                 wide = power_of_two(2 * Shape.columns - 1);

public:
    /// Elements from one row of a map to the next.
    static constexpr std::size_t stride = padded_size<double>(Shape.columns);
    static constexpr std::size_t size = Shape.rows * stride;
    /// A transformed kernel. The spectrum of a sum of kernels is the sum of their spectra.
    using spectrum = aligned_vector<double>;

    symmetric_convolution() : upright_(stride * tall), lying_(frequencies * wide) {}

    /// `kernel(rows, columns)` is the influence of a cell on another so many rows and columns away.
    template <class Kernel>
    [[nodiscard]] spectrum spectrum_of(const Kernel& kernel) {
        std::fill(upright_.begin(), upright_.end(), 0.0);
        for (std::size_t y = 0; y < Shape.rows; ++y)
            for (std::size_t x = 0; x < Shape.columns; ++x) {
                const double value = kernel(y, x);
                upright(y, x) = value;
                upright(y > 0 ? tall - y : 0, x) = value;
            }
        transform_columns();
        std::fill(lying_.begin(), lying_.end(), 0.0);
        transpose();
        for (std::size_t f = 0; f < frequencies; ++f)
            for (std::size_t x = 1; x < Shape.columns; ++x)
                lying(f, wide - x) = lying(f, x);
        for (std::size_t group = 0; group < frequencies; group += width)
            along_rows_.to_reversed(lying_.data() + group * wide);
        spectrum result(lying_);
        for (double& each : result)
            each /= static_cast<double>(tall * wide); // forward and inverse transform together scale by this
        return result;
    }

    /// `to` may be `from`.
    void convolve(const spectrum& kernel, const double* from, double* to) noexcept {
        for (std::size_t group = 0; group < stride; group += width) {
            double* const block = upright_.data() + group * tall;
            for (std::size_t y = 0; y < Shape.rows; ++y)
                store(block + y * width, load(from + y * stride + group));
            std::fill(block + Shape.rows * width, block + tall * width, 0.0);
        }
        transform_columns();
        transpose();
        for (std::size_t group = 0; group < frequencies; group += width) {
            double* const block = lying_.data() + group * wide;
            std::fill(block + Shape.columns * width, block + wide * width, 0.0);
            along_rows_.to_reversed(block);
            const double* const factors = kernel.data() + group * wide;
            for (std::size_t i = 0; i < wide * width; i += width)
                store(block + i, load(block + i) * load(factors + i));
            along_rows_.from_reversed(block);
        }
        transpose_back();
        for (std::size_t group = 0; group < stride; group += width) {
            double* const block = upright_.data() + group * tall;
            along_columns_.from_reversed(block);
            for (std::size_t y = 0; y < Shape.rows; ++y)
                store(to + y * stride + group, load(block + y * width));
        }
    }

private:
    // Signals lie side by side in blocks of one vector, with all samples of a block one after the other:
    // columns upright, rows of frequencies lying.
    static constexpr std::size_t frequencies = padded_size<double>(tall);
    double& upright(std::size_t row, std::size_t column) {
        return upright_[column / width * width * tall + row * width + column % width];
    }
    double& lying(std::size_t frequency, std::size_t column) {
        return lying_[frequency / width * width * wide + column * width + frequency % width];
    }

    void transform_columns() {
        for (std::size_t group = 0; group < stride; group += width)
            along_columns_.to_reversed(upright_.data() + group * tall);
    }
    void transpose() {
        for (std::size_t group = 0; group < frequencies; group += width)
            for (std::size_t x = 0; x < Shape.columns; ++x)
                for (std::size_t f = group; f < std::min(group + width, tall); ++f)
                    lying(f, x) = upright(f, x);
    }
    void transpose_back() {
        for (std::size_t group = 0; group < stride; group += width)
            for (std::size_t f = 0; f < tall; ++f)
                for (std::size_t x = group; x < std::min(group + width, Shape.columns); ++x)
                    upright(f, x) = lying(f, x);
    }

    hartley<tall> along_columns_;
    hartley<wide> along_rows_;
    aligned_vector<double> upright_, lying_;
};

}}} // namespace tactnet::kernels
