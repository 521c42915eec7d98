#pragma once

#include <tactnet/kernels/map/hartley.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/aligned.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

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
