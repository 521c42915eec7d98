#pragma once

#include <tactnet/detail/arithmetic.hpp>

#include <cstddef>

// Sizes as compile-time constants. All are structural types, so that they can be template arguments.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The size of one sample: a pressure image of `rows` × `columns` tactels, or `channels` feature maps.
/// Elements are ordered [channel][row][column].
struct shape {
    std::size_t rows = 1;
    std::size_t columns = 1;
    std::size_t channels = 1;

    [[nodiscard]] constexpr std::size_t area() const { return rows * columns; }
    [[nodiscard]] constexpr std::size_t size() const { return rows * columns * channels; }
    friend constexpr bool operator==(const shape&, const shape&) = default;
};

/// Rows and columns of a kernel, a window or a stride. One number sets both.
struct extent2d {
    std::size_t rows;
    std::size_t columns;

    constexpr extent2d(std::size_t both)
        : rows(both), columns(both) {} // implicit: conv2d<8, 5> reads as 5 × 5
    constexpr extent2d(std::size_t rows_, std::size_t columns_) : rows(rows_), columns(columns_) {}
    [[nodiscard]] constexpr std::size_t area() const { return rows * columns; }
    friend constexpr bool operator==(const extent2d&, const extent2d&) = default;
};

/// The border around an image before a window slides over it.
struct padding {
    /// How many outputs to keep: ceil(size / stride), those of the given border, or the same rounded up.
    enum class rule { same, given, ceil_mode };

    rule how = rule::same;
    std::size_t top = 0, bottom = 0, left = 0, right = 0;

    /// Keeps ceil(size / stride) outputs. The zeros are split in halves, and an odd one goes to the bottom
    /// and to the right, so that an even kernel is padded only there.
    static const padding same;
    /// No padding.
    static const padding valid;

    friend constexpr bool operator==(const padding&, const padding&) = default;
};

inline constexpr padding padding::same{};
inline constexpr padding padding::valid{padding::rule::given};

/// Explicit padding: the same on all sides, or per side.
[[nodiscard]] constexpr padding pad(std::size_t all) {
    return {padding::rule::given, all, all, all, all};
}
/// Explicit zeros on each side.
[[nodiscard]] constexpr padding pad(std::size_t top, std::size_t bottom, std::size_t left,
                                    std::size_t right) {
    return {padding::rule::given, top, bottom, left, right};
}

/// The given padding, extended at the bottom and on the right for a last window that does not fit: the number
/// of outputs is rounded up as by PyTorch's ceil_mode. That window must begin inside the image or its padding
/// at the top and on the left.
[[nodiscard]] constexpr padding ceil_mode(padding around = padding::valid) {
    around.how = padding::rule::ceil_mode;
    return around;
}

/// A window that slides over an image: where its taps fall.
struct sliding_window {
    shape input;
    extent2d kernel;
    extent2d stride;
    std::size_t top = 0, bottom = 0, left = 0, right = 0;

    /// Resolves a padding rule for one input. A stride of zero counts as one; layers reject it.
    [[nodiscard]] static constexpr sliding_window over(shape input, extent2d kernel, extent2d stride,
                                                       padding around) {
        stride = {stride.rows > 0 ? stride.rows : 1, stride.columns > 0 ? stride.columns : 1};
        sliding_window w{input, kernel, stride};
        if (around.how != padding::rule::same) {
            w.top = around.top, w.bottom = around.bottom, w.left = around.left, w.right = around.right;
            if (around.how == padding::rule::ceil_mode) {
                w.bottom = completed(input.rows, kernel.rows, stride.rows, w.top, w.bottom);
                w.right = completed(input.columns, kernel.columns, stride.columns, w.left, w.right);
            }
        } else {
            const std::size_t vertical = missing(input.rows, kernel.rows, stride.rows);
            const std::size_t horizontal = missing(input.columns, kernel.columns, stride.columns);
            w.top = vertical / 2, w.bottom = vertical - vertical / 2;
            w.left = horizontal / 2, w.right = horizontal - horizontal / 2;
        }
        return w;
    }

    /// Whether the padded input holds the window at least once.
    [[nodiscard]] constexpr bool fits() const {
        return input.rows + top + bottom >= kernel.rows && input.columns + left + right >= kernel.columns;
    }
    [[nodiscard]] constexpr std::size_t output_rows() const {
        return fits() ? (input.rows + top + bottom - kernel.rows) / stride.rows + 1 : 1;
    }
    [[nodiscard]] constexpr std::size_t output_columns() const {
        return fits() ? (input.columns + left + right - kernel.columns) / stride.columns + 1 : 1;
    }

    /// The taps of one channel, over all outputs, that fall on pixels and not on padding.
    [[nodiscard]] constexpr std::size_t taps_on_pixels() const {
        return count(output_rows(), kernel.rows, stride.rows, top, input.rows) *
               count(output_columns(), kernel.columns, stride.columns, left, input.columns);
    }

    friend constexpr bool operator==(const sliding_window&, const sliding_window&) = default;

private:
    static constexpr std::size_t missing(std::size_t size, std::size_t kernel, std::size_t stride) {
        const std::size_t outputs = detail::ceil_div(size, stride);
        const std::size_t reach = (outputs - 1) * stride + kernel;
        return reach > size ? reach - size : 0;
    }
    /// The padding after the image that completes the last window which begins inside.
    static constexpr std::size_t completed(std::size_t size, std::size_t kernel, std::size_t stride,
                                           std::size_t before, std::size_t after) {
        if (size + before + after < kernel)
            return after;
        std::size_t outputs = detail::ceil_div(size + before + after - kernel, stride) + 1;
        while (outputs > 1 && (outputs - 1) * stride >= size + before)
            --outputs;
        const std::size_t reach = (outputs - 1) * stride + kernel;
        return reach > size + before + after ? reach - size - before : after;
    }
    static constexpr std::size_t count(std::size_t outputs, std::size_t kernel, std::size_t stride,
                                       std::size_t before, std::size_t size) {
        std::size_t taps = 0;
        for (std::size_t k = 0; k < kernel; ++k) {
            // Outputs o with before <= o * stride + k < before + size.
            const std::size_t first = k >= before ? 0 : detail::ceil_div(before - k, stride);
            const std::size_t end = k >= before + size ? 0 : detail::ceil_div(before + size - k, stride);
            taps += end > first ? (end < outputs ? end : outputs) - (first < outputs ? first : outputs) : 0;
        }
        return taps;
    }
};

}} // namespace tactnet
