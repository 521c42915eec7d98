#pragma once

#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>

// Convolution of one frame, for deployed networks. Maps lie pixel by pixel, the channels of a pixel side by
// side and padded to whole vectors: a tap is then one number of the input, spread over all lanes, times
// vectors of output channels. A block of pixels × vectors stays in registers while all taps are added, then
// max pool and ReLU are applied to the block, so that what is pooled away is never stored.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// One fused step: convolution, a sum with another map or a max pool of windows side by side, ReLU.
struct frame_convolution {
    sliding_window window;
    std::size_t filters;
    std::size_t input_stride; ///< elements from one pixel of the input to the next
    extent pool = 1;          ///< window and stride of the max pool behind, without padding before the image
    std::size_t pooled_rows = 0, pooled_columns = 0; ///< of the output, if a pool cuts or completes windows
    bool rectified = false;
    bool adds = false;          ///< to the map that the output takes the place of
    std::size_t groups = 1;     ///< filters of a group see the channels of that group only
    std::size_t map_stride = 0; ///< elements from one pixel to the next of a wider map that holds the output
    std::size_t map_offset = 0; ///< channels of that map in front of the output; 0 also without one
    std::size_t input_offset = 0; ///< the first channel of the input is a multiple of this; 0: aligned

    /// Of a register block: more of them, beside inputs and weights, and compilers spill.
    static constexpr std::size_t most_accumulators = vector_registers == 32 ? 16 : 12;

    /// In a wider map vectors must begin where vectors of that width may lie.
    [[nodiscard]] constexpr std::size_t width() const {
        std::size_t w = lanes_for<float>(filters);
        while (w > fewest_lanes<float> && (map_stride % w != 0 || map_offset % w != 0))
            w /= 2;
        return w;
    }
    [[nodiscard]] constexpr std::size_t vectors() const { return (filters + width() - 1) / width(); }
    [[nodiscard]] constexpr std::size_t padded_filters() const { return vectors() * width(); }
    [[nodiscard]] constexpr std::size_t output_stride() const {
        return map_stride > 0 ? map_stride : padded_filters();
    }
    /// Products of one output.
    [[nodiscard]] constexpr std::size_t taps() const {
        return window.input.channels / groups * window.kernel.area();
    }
    /// Elements of the packed weights, then of the biases.
    [[nodiscard]] constexpr std::size_t weights() const { return taps() * padded_filters(); }

    /// Whether the output fits into its place in a wider map: lanes behind its last channel must not reach
    /// the next pixel.
    [[nodiscard]] constexpr bool fits_map() const {
        return map_stride == 0 || (map_stride % width() == 0 && map_offset % width() == 0 &&
                                   map_offset + padded_filters() <= map_stride);
    }
    /// Whether groups can be computed one by one: their filters must fill vectors.
    [[nodiscard]] constexpr bool groups_apart() const {
        return groups > 1 && group().padded_filters() == group().filters && group().fits_map();
    }
    /// One of several groups, as a convolution from and into some channels of wider maps.
    [[nodiscard]] constexpr frame_convolution group() const {
        frame_convolution one = *this;
        one.window.input.channels /= groups, one.filters /= groups, one.groups = 1;
        one.map_stride = output_stride();
        one.map_offset = std::gcd(map_offset, one.filters);
        one.input_offset = std::gcd(input_offset, one.window.input.channels);
        return one;
    }
    /// All groups as one convolution, with zeros for what a group does not see.
    [[nodiscard]] constexpr frame_convolution joined() const {
        frame_convolution all = *this;
        all.groups = 1;
        return all;
    }

    [[nodiscard]] constexpr std::size_t output_rows() const {
        return pooled_rows > 0 ? pooled_rows : window.output_rows();
    }
    [[nodiscard]] constexpr std::size_t output_columns() const {
        return pooled_columns > 0 ? pooled_columns : window.output_columns();
    }
    /// Pixels before pooling that count.
    [[nodiscard]] constexpr std::size_t rows() const {
        return std::min(window.output_rows(), output_rows() * pool.rows);
    }
    [[nodiscard]] constexpr std::size_t columns() const {
        return std::min(window.output_columns(), output_columns() * pool.columns);
    }

    /// Vectors of output channels in a register block.
    [[nodiscard]] constexpr std::size_t block_vectors() const { return std::min<std::size_t>(vectors(), 2); }
    [[nodiscard]] constexpr std::size_t block_rows() const {
        return pool.rows > 1 ? pool.rows : std::min<std::size_t>(rows(), 2);
    }
    /// Columns of a block: as many as registers allow, evenly spread over the image.
    [[nodiscard]] constexpr std::size_t block_columns() const {
        const std::size_t step = pool.columns;
        const std::size_t most =
            std::max(most_accumulators / (block_rows() * block_vectors()) / step * step, step);
        const std::size_t blocks = (columns() + most - 1) / most;
        const std::size_t even = (columns() + blocks - 1) / blocks;
        return (even + step - 1) / step * step;
    }
    friend constexpr bool operator==(const frame_convolution&, const frame_convolution&) = default;
};

/// Weights in the order of use: blocks of vectors of filters, then [channel][kernel row][kernel
/// column][filter of the block]; zeros where there is no filter. `weight(filter, channel, row, column)`.
template <frame_convolution C, class Weight>
constexpr void pack_frame_weights(float* packed, Weight&& weight) {
    const std::size_t block = C.block_vectors() * C.width();
    for (std::size_t first = 0; first < C.padded_filters(); first += block) {
        const std::size_t count = std::min(block, C.padded_filters() - first);
        for (std::size_t channel = 0; channel < C.window.input.channels; ++channel)
            for (std::size_t row = 0; row < C.window.kernel.rows; ++row)
                for (std::size_t column = 0; column < C.window.kernel.columns; ++column)
                    for (std::size_t f = first; f < first + count; ++f)
                        *packed++ = f < C.filters ? weight(f, channel, row, column) : 0.0f;
    }
}

/// Where a register block lies.
struct frame_block {
    std::ptrdiff_t first_pixel;      ///< of the input under its first tap; may lie before the image
    std::size_t first_row, last_row; ///< of the rows under its taps, those that are in the image
};

/// One register block: `Rows` × `Columns` neighbouring outputs before pooling × `Vectors` vectors of filters.
/// `MissingLeft` and `MissingRight` of the columns under its taps are padding.
template <frame_convolution C, std::size_t Vectors, std::size_t Rows, std::size_t Columns,
          std::size_t MissingLeft, std::size_t MissingRight>
[[gnu::flatten, gnu::noinline]] void convolve_block(const float* input, const float* weights,
                                                    const float* bias, float* output, frame_block where) {
    using wide = sized_vector<float, C.width()>;
    constexpr std::size_t width = C.width(), step = C.window.stride.columns;
    constexpr extent kernel = C.window.kernel;
    constexpr std::size_t under_rows = (Rows - 1) * C.window.stride.rows + kernel.rows;
    constexpr std::size_t under_columns = (Columns - 1) * step + kernel.columns;
    constexpr auto stride = static_cast<std::ptrdiff_t>(C.input_stride);

    register_block<wide, Rows * Columns, Vectors> sums;
    unroll<Vectors>([&](auto v) __attribute__((always_inline)) {
        const wide start = load_as<wide>(bias + v * width);
        unroll<Rows * Columns>([&](auto p) __attribute__((always_inline)) {
            if constexpr (C.adds)
                sums[p][v] = start + load_as<wide>(output +
                                                   (p / Columns * C.output_columns() + p % Columns) *
                                                       C.output_stride() +
                                                   v * width);
            else
                sums[p][v] = start;
        });
    });

    for (std::size_t channel = 0; channel < C.window.input.channels; ++channel) {
        unroll<under_rows>([&](auto r) __attribute__((always_inline)) {
            if (r < where.first_row || r >= where.last_row)
                return;
            const std::ptrdiff_t row =
                (where.first_pixel + static_cast<std::ptrdiff_t>(r * C.window.input.columns)) * stride;
            std::array<wide, under_columns> x;
            unroll<under_columns>([&](auto c) __attribute__((always_inline)) {
                if constexpr (c >= MissingLeft && c + MissingRight < under_columns)
                    x[c] = wide(input[row + static_cast<std::ptrdiff_t>(c) * stride]);
            });
            unroll<Rows>([&](auto y) __attribute__((always_inline)) {
                constexpr std::size_t above = y * C.window.stride.rows;
                if constexpr (r >= above && r - above < kernel.rows)
                    unroll<kernel.columns * Vectors>([&](auto tap) __attribute__((always_inline)) {
                        constexpr std::size_t column = tap / Vectors, v = tap % Vectors;
                        const wide weight = load_as<wide>(
                            weights + (((r - above) * kernel.columns + column) * Vectors + v) * width);
                        unroll<Columns>([&](auto p) __attribute__((always_inline)) {
                            constexpr std::size_t c = p * step + column;
                            if constexpr (c >= MissingLeft && c + MissingRight < under_columns)
                                sums[y * Columns + p][v] =
                                    fused_multiply_add(weight, x[c], sums[y * Columns + p][v]);
                        });
                    });
            });
        });
        ++input;
        weights += kernel.area() * Vectors * width;
    }

    constexpr std::size_t pooled_columns = (Columns + C.pool.columns - 1) / C.pool.columns;
    unroll<(Rows + C.pool.rows - 1) / C.pool.rows * pooled_columns>([&](
        auto o) __attribute__((always_inline)) {
        constexpr std::size_t top = o / pooled_columns * C.pool.rows,
                              left = o % pooled_columns * C.pool.columns;
        constexpr std::size_t high = std::min(C.pool.rows, Rows - top),
                              across = std::min(C.pool.columns, Columns - left);
        unroll<Vectors>([&](auto v) __attribute__((always_inline)) {
            wide largest = sums[top * Columns + left][v];
            unroll<high * across>([&](auto i) __attribute__((always_inline)) {
                if constexpr (i > 0)
                    largest =
                        maximum_or_second(sums[(top + i / across) * Columns + left + i % across][v], largest);
            });
            if constexpr (C.rectified)
                largest = maximum_or_second(wide(0.0f), largest);
            store_as(output +
                         (o / pooled_columns * C.output_columns() + o % pooled_columns) * C.output_stride() +
                         v * width,
                     largest);
        });
    });
}

/// How the columns of a convolution are cut into register blocks.
template <frame_convolution C>
struct column_blocks {
    static constexpr std::size_t size = C.block_columns(), count = (C.columns() + size - 1) / size;

    static constexpr std::size_t columns(std::size_t b) { return std::min(size, C.columns() - b * size); }
    static constexpr std::size_t missing_left(std::size_t b) {
        return C.window.left - std::min(C.window.left, b * size * C.window.stride.columns);
    }
    static constexpr std::size_t missing_right(std::size_t b) {
        const std::size_t end =
            (b * size + columns(b) - 1) * C.window.stride.columns + C.window.kernel.columns;
        return end - std::min(end, C.window.left + C.window.input.columns);
    }
    static constexpr bool whole(std::size_t b) {
        return columns(b) == size && missing_left(b) == 0 && missing_right(b) == 0;
    }
    /// The blocks [first_whole, last_whole) have all columns and no padding: one piece of code for all.
    static constexpr std::size_t first_whole = [] {
        std::size_t b = 0;
        while (b < count && !whole(b))
            ++b;
        return b;
    }();
    static constexpr std::size_t last_whole = [] {
        std::size_t b = first_whole;
        while (b < count && whole(b))
            ++b;
        return b;
    }();
};

/// All blocks of `Rows` rows of outputs from row `y` on.
template <frame_convolution C, std::size_t Vectors, std::size_t Rows>
[[gnu::always_inline]] inline void convolve_rows(const float* input, const float* weights, const float* bias,
                                                 float* output, std::size_t y) {
    using blocks = column_blocks<C>;
    constexpr std::size_t under_rows = (Rows - 1) * C.window.stride.rows + C.window.kernel.rows;
    const std::size_t first = y * C.window.stride.rows; // row under the first tap, counted with the padding
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(first) - static_cast<std::ptrdiff_t>(C.window.top);
    float* const to = output + y / C.pool.rows * C.output_columns() * C.output_stride();
    const auto at = [&](std::size_t b) -> frame_block {
        return {.first_pixel = row * static_cast<std::ptrdiff_t>(C.window.input.columns) +
                               static_cast<std::ptrdiff_t>(b * blocks::size * C.window.stride.columns) -
                               static_cast<std::ptrdiff_t>(C.window.left),
                .first_row = C.window.top - std::min(C.window.top, first),
                .last_row =
                    std::min(under_rows, std::max(C.window.top + C.window.input.rows, first) - first)};
    };
    const auto output_of = [&](std::size_t b) {
        return to + b * blocks::size / C.pool.columns * C.output_stride();
    };
    const auto edge = [&](auto b) {
        convolve_block<C, Vectors, Rows, blocks::columns(b), blocks::missing_left(b),
                       blocks::missing_right(b)>(input, weights, bias, output_of(b), at(b));
    };
    unroll<blocks::first_whole>(edge);
    for (std::size_t b = blocks::first_whole; b < blocks::last_whole; ++b)
        convolve_block<C, Vectors, Rows, blocks::size, 0, 0>(input, weights, bias, output_of(b), at(b));
    unroll<blocks::count - blocks::last_whole>([&](auto b) __attribute__((always_inline)) {
        edge(constant<blocks::last_whole + b>{});
    });
}

/// output = the fused step. Input and output lie pixel by pixel; weights and biases are packed, aligned to
/// `alignment`, as is the output. With `adds`, the output holds the other term before.
template <frame_convolution C>
void convolve_frame(const float* input, const float* weights, const float* bias, float* output) {
    static_assert(!C.adds || C.pool == extent(1), "convolve_frame: a sum is not pooled");
    static_assert(C.groups == 1 && C.fits_map(), "convolve_frame: the output does not fit its map");
    blocked<C.vectors(), C.block_vectors()>([&](auto vectors, std::size_t first_vector) {
        const std::size_t first = first_vector * C.width();
        constexpr std::size_t rows = C.block_rows();
        for (std::size_t y = 0; y + rows <= C.rows(); y += rows)
            convolve_rows<C, vectors, rows>(input, weights + first * C.taps(), bias + first, output + first,
                                            y);
        if constexpr (C.rows() % rows != 0)
            convolve_rows<C, vectors, C.rows() % rows>(input, weights + first * C.taps(), bias + first,
                                                       output + first, C.rows() / rows * rows);
    });
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
