#pragma once

// Magnitudes of the terms that go through Winograd's tiles, for bounds of the errors of what is computed by
// them (deployed_reference.hpp says how). In double precision and by plain loops.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <support/layers/reference.hpp>
#include <vector>

namespace support {

/// Magnitudes of the factors in Winograd's lines, with so many outputs of a kernel of so many numbers. Row j
/// of |G| and column j of |A|ᵀ hold powers of point j; those at infinity hold one number.
class tile_line {
public:
    tile_line(std::size_t outputs, std::size_t kernel) : outputs_(outputs), kernel_(kernel) {}

    [[nodiscard]] std::size_t side() const { return outputs_ + kernel_ - 1; }
    [[nodiscard]] std::size_t outputs() const { return outputs_; }
    [[nodiscard]] double g(std::size_t line, std::size_t at) const {
        static constexpr double of3[] = {1, 1}, of4[] = {1, .5, .5},
                                of5[] = {root / 3, root / 3, root / 6, root / 6},
                                of6[] = {1, 2.0 / 3, 2.0 / 3, 1.0 / 6, 1.0 / 6};
        static constexpr const double* factors[] = {of3, of4, of5, of6};
        if (line + 1 == side())
            return at + 1 == kernel_ ? 1 : 0;
        return factors[side() - 3][line] * power(line, at);
    }
    [[nodiscard]] double b(std::size_t line, std::size_t at) const {
        static constexpr double of3[3][3] = {{1, 1, 0}, {0, 1, 0}, {0, 1, 1}};
        static constexpr double of4[4][4] = {{1, 0, 1, 0}, {0, 1, 1, 0}, {0, 1, 1, 0}, {0, 1, 0, 1}};
        static constexpr double of6[6][6] = {{1, 0, 2.5, 0, 1, 0},          {0, root, 2, root / 2, 1, 0},
                                             {0, root, 2, root / 2, 1, 0},  {0, root / 2, .5, root, 1, 0},
                                             {0, root / 2, .5, root, 1, 0}, {0, 1, 0, 2.5, 0, 1}};
        return side() == 3   ? of3[line][at]
               : side() == 4 ? of4[line][at]
               : side() == 5 ? of6[line + 1][at + 1]
                             : of6[line][at];
    }
    [[nodiscard]] double a(std::size_t output, std::size_t at) const {
        return at + 1 == side() ? (output + 1 == outputs_ ? 1 : 0) : power(at, output);
    }

private:
    static constexpr double root = 1.41421356237309504880;
    [[nodiscard]] double power(std::size_t point, std::size_t exponent) const {
        static constexpr double few[] = {0, 1, 1}, many[] = {0, root / 2, root / 2, root, root};
        const double at = side() <= 4 ? few[point] : many[point + 6 - side()];
        return exponent == 0 ? 1 : std::pow(at, static_cast<double>(exponent));
    }
    std::size_t outputs_, kernel_;
};

/// Magnitudes of all terms that go through the tiles of one convolution, for each output, from those of the
/// input.
class tile_magnitudes {
public:
    tile_magnitudes(const reference_window& window, std::size_t filters, std::span<const double> weights,
                    std::span<const double> in, tile_size outputs)
        : window_(window),
          down_(outputs.rows, window.kernel_rows),
          across_(outputs.columns, window.kernel_columns),
          elements_(down_.side() * across_.side()) {
        const std::size_t channels = window.input.channels, rows = window.output_rows(),
                          columns = window.output_columns();
        std::vector<double> kernels(filters * channels * elements_);
        for (std::size_t k = 0; k < filters * channels; ++k)
            transform_kernel(weights.data() + k * window.kernel_rows * window.kernel_columns,
                             kernels.data() + k * elements_);
        sizes.assign(filters * rows * columns, 0);
        std::vector<double> tile(channels * elements_), products(elements_);
        for (std::size_t y = 0; y < rows; y += outputs.rows)
            for (std::size_t x = 0; x < columns; x += outputs.columns) {
                for (std::size_t c = 0; c < channels; ++c)
                    transform_input(in, c, y, x, tile.data() + c * elements_);
                for (std::size_t f = 0; f < filters; ++f) {
                    std::fill(products.begin(), products.end(), 0.0);
                    for (std::size_t c = 0; c < channels; ++c)
                        for (std::size_t e = 0; e < elements_; ++e)
                            products[e] +=
                                kernels[(f * channels + c) * elements_ + e] * tile[c * elements_ + e];
                    for (std::size_t down = 0; down < outputs.rows && y + down < rows; ++down)
                        for (std::size_t across = 0; across < outputs.columns && x + across < columns;
                             ++across)
                            sizes[(f * rows + y + down) * columns + x + across] =
                                output(products, down, across);
                }
            }
    }

    std::vector<double> sizes;

private:
    void transform_kernel(const double* kernel, double* to) const {
        const std::size_t rows = window_.kernel_rows, columns = window_.kernel_columns;
        for (std::size_t e = 0; e < elements_; ++e) {
            double sum = 0;
            for (std::size_t i = 0; i < rows * columns; ++i)
                sum += down_.g(e / across_.side(), i / columns) * std::abs(kernel[i]) *
                       across_.g(e % across_.side(), i % columns);
            to[e] = sum;
        }
    }
    void transform_input(std::span<const double> in, std::size_t channel, std::size_t row, std::size_t column,
                         double* to) const {
        std::array<double, 36> d{};
        for (std::size_t i = 0; i < elements_; ++i) { // counted with the padding
            const std::size_t y = row + i / across_.side(), x = column + i % across_.side();
            if (y >= window_.top && y < window_.top + window_.input.rows && x >= window_.left &&
                x < window_.left + window_.input.columns)
                d[i] = in[(channel * window_.input.rows + y - window_.top) * window_.input.columns + x -
                          window_.left];
        }
        for (std::size_t e = 0; e < elements_; ++e) {
            double sum = 0;
            for (std::size_t i = 0; i < elements_; ++i)
                sum += down_.b(e / across_.side(), i / across_.side()) * d[i] *
                       across_.b(e % across_.side(), i % across_.side());
            to[e] = sum;
        }
    }
    [[nodiscard]] double output(const std::vector<double>& products, std::size_t y, std::size_t x) const {
        double sum = 0;
        for (std::size_t i = 0; i < elements_; ++i)
            sum += down_.a(y, i / across_.side()) * products[i] * across_.a(x, i % across_.side());
        return sum;
    }

    reference_window window_;
    tile_line down_, across_;
    std::size_t elements_;
};

/// By how much the deviation of a tile's errors exceeds that of the same sums by taps, where numbers are
/// independent and alike: of the output that fares worst, the squares of all factors on its way compared with
/// those of the taps, and the roundings that a term passes (deployed_reference.hpp).
[[nodiscard]] inline double tile_deviation(std::size_t channels, std::size_t kernel, tile_size outputs) {
    const auto gain = [&](std::size_t count) {
        const tile_line line(count, kernel);
        double most = 0;
        for (std::size_t o = 0; o < count; ++o) {
            double sum = 0;
            for (std::size_t e = 0; e < line.side(); ++e) {
                double g = 0, b = 0;
                for (std::size_t k = 0; k < kernel; ++k)
                    g += line.g(e, k) * line.g(e, k);
                for (std::size_t i = 0; i < line.side(); ++i)
                    b += line.b(e, i) * line.b(e, i);
                sum += line.a(o, e) * line.a(o, e) * g * b;
            }
            most = std::max(most, sum / static_cast<double>(kernel));
        }
        return most;
    };
    const auto c = static_cast<double>(channels), taps = static_cast<double>(kernel * kernel);
    return std::sqrt(gain(outputs.rows) * gain(outputs.columns) * (c + 23) / (taps * c + 3));
}

/// Magnitudes for the gradient of the weights, [filter][channel][row][column] as they are, from the
/// magnitudes of the input and of the outputs' gradient, added to `sizes`: |G|ᵀ [Σ (|B|ᵀ |d| |B|) ∘ (|A| |δ|
/// |A|ᵀ)] |G|.
inline void add_gradient_magnitudes(const reference_window& window, std::size_t filters,
                                    std::span<const double> in, std::span<const double> gradient,
                                    tile_size outputs, std::span<double> sizes) {
    const tile_line down(outputs.rows, window.kernel_rows), across(outputs.columns, window.kernel_columns);
    const std::size_t channels = window.input.channels, rows = window.output_rows(),
                      columns = window.output_columns(), elements = down.side() * across.side(),
                      taps = window.kernel_rows * window.kernel_columns;
    std::vector<double> sums(filters * channels * elements), d(channels * elements), g(filters * elements);
    for (std::size_t y = 0; y < rows; y += outputs.rows)
        for (std::size_t x = 0; x < columns; x += outputs.columns) {
            for (std::size_t c = 0; c < channels; ++c)
                for (std::size_t e = 0; e < elements; ++e) {
                    double& sum = d[c * elements + e] = 0;
                    for (std::size_t i = 0; i < elements; ++i) { // counted with the padding
                        const std::size_t row = y + i / across.side(), column = x + i % across.side();
                        if (row >= window.top && row < window.top + window.input.rows &&
                            column >= window.left && column < window.left + window.input.columns)
                            sum += down.b(e / across.side(), i / across.side()) *
                                   in[(c * window.input.rows + row - window.top) * window.input.columns +
                                      column - window.left] *
                                   across.b(e % across.side(), i % across.side());
                    }
                }
            for (std::size_t f = 0; f < filters; ++f)
                for (std::size_t e = 0; e < elements; ++e) {
                    double& sum = g[f * elements + e] = 0;
                    for (std::size_t i = 0; i < outputs.rows * outputs.columns; ++i) {
                        const std::size_t row = i / outputs.columns, column = i % outputs.columns;
                        if (y + row < rows && x + column < columns)
                            sum += down.a(row, e / across.side()) *
                                   gradient[(f * rows + y + row) * columns + x + column] *
                                   across.a(column, e % across.side());
                    }
                }
            for (std::size_t k = 0; k < filters * channels; ++k)
                for (std::size_t e = 0; e < elements; ++e)
                    sums[k * elements + e] += d[k % channels * elements + e] * g[k / channels * elements + e];
        }
    for (std::size_t w = 0; w < sizes.size(); ++w)
        for (std::size_t e = 0; e < elements; ++e)
            sizes[w] += down.g(e / across.side(), w % taps / window.kernel_columns) *
                        sums[w / taps * elements + e] *
                        across.g(e % across.side(), w % taps % window.kernel_columns);
}

} // namespace support
