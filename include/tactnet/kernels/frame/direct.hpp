#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/method_list.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// Direct convolution of one frame. Maps lie pixel by pixel, the channels of a pixel side by side and padded
// to whole vectors: a tap multiplies one number of the input, broadcast to all lanes, with vectors of
// filters. A block of pixels × vectors stays in registers while all taps are added; then max pool and
// activation function are applied to the block, so that only pooled values are stored.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The position of a register block.
struct frame_block {
    std::ptrdiff_t first_pixel;      ///< of the input under its first tap; may lie before the image
    std::size_t first_row, last_row; ///< the rows under its taps that are in the image
};

/// One register block: `Rows` × `Columns` neighbouring outputs before pooling × `Vectors` vectors of filters.
/// `MissingLeft` and `MissingRight` of the columns under its taps are padding.
template <frame_convolution C, std::size_t Vectors, std::size_t Rows, std::size_t Columns,
          std::size_t MissingLeft, std::size_t MissingRight>
[[gnu::flatten, gnu::noinline]] void convolve_block(const float* input, const float* weights,
                                                    const float* bias, float* output, frame_block where) {
    using wide = sized_vector<float, C.width()>;
    constexpr std::size_t width = C.width(), step = C.window.stride.columns;
    constexpr extent2d kernel = C.window.kernel;
    constexpr std::size_t footprint_rows = (Rows - 1) * C.window.stride.rows + kernel.rows;
    constexpr std::size_t under_columns = (Columns - 1) * step + kernel.columns;
    constexpr auto stride = static_cast<std::ptrdiff_t>(C.input_stride);

    register_block<wide, Rows * Columns, Vectors> sums;
#pragma GCC unroll 64
    for (std::size_t v = 0; v < Vectors; ++v) {
        const wide start = load_as<wide>(bias + v * width);
#pragma GCC unroll 64
        for (std::size_t p = 0; p < Rows * Columns; ++p)
            if constexpr (C.accumulates)
                sums[p][v] = start + load_as<wide>(output +
                                                   (p / Columns * C.output_columns() + p % Columns) *
                                                       C.output_stride() +
                                                   v * width);
            else
                sums[p][v] = start;
    }

    for (std::size_t channel = 0; channel < C.window.input.channels; ++channel) {
        prefetch_weights<kernel.area() * Vectors * width * sizeof(float), C.weights() * sizeof(float),
                         Rows * Columns>(weights + prefetch_distance_bytes / sizeof(float));
#pragma GCC unroll 64
        for (std::size_t r = 0; r < footprint_rows; ++r) {
            if (r < where.first_row || r >= where.last_row)
                continue;
            const std::ptrdiff_t row =
                (where.first_pixel + static_cast<std::ptrdiff_t>(r * C.window.input.columns)) * stride;
            std::array<broadcast<wide>, under_columns> x;
#pragma GCC unroll 64
            for (std::size_t c = MissingLeft; c + MissingRight < under_columns; ++c)
                x[c] = broadcast<wide>(input[row + static_cast<std::ptrdiff_t>(c) * stride]);
#pragma GCC unroll 64
            for (std::size_t y = 0; y < Rows; ++y) {
                const std::size_t above = y * C.window.stride.rows;
                if (r < above || r - above >= kernel.rows)
                    continue;
#pragma GCC unroll 64
                for (std::size_t tap = 0; tap < kernel.columns * Vectors; ++tap) {
                    const std::size_t column = tap / Vectors, v = tap % Vectors;
                    const wide weight = load_as<wide>(
                        weights + (((r - above) * kernel.columns + column) * Vectors + v) * width);
#pragma GCC unroll 64
                    for (std::size_t p = 0; p < Columns; ++p) {
                        const std::size_t c = p * step + column;
                        if (c >= MissingLeft && c + MissingRight < under_columns)
                            sums[y * Columns + p][v] =
                                fused_multiply_add(weight, x[c], sums[y * Columns + p][v]);
                    }
                }
            }
        }
        ++input;
        weights += kernel.area() * Vectors * width;
    }

    constexpr std::size_t pooled_rows = ceil_div(Rows, C.pool.rows),
                          pooled_columns = ceil_div(Columns, C.pool.columns);
#pragma GCC unroll 64
    for (std::size_t o = 0; o < pooled_rows * pooled_columns; ++o) {
        const std::size_t top = o / pooled_columns * C.pool.rows, left = o % pooled_columns * C.pool.columns;
        const std::size_t high = std::min(C.pool.rows, Rows - top),
                          across = std::min(C.pool.columns, Columns - left);
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v) {
            wide largest = sums[top * Columns + left][v];
#pragma GCC unroll 64
            for (std::size_t i = 1; i < high * across; ++i)
                largest =
                    maximum_or_second(sums[(top + i / across) * Columns + left + i % across][v], largest);
            store_as(output +
                         (o / pooled_columns * C.output_columns() + o % pooled_columns) * C.output_stride() +
                         v * width,
                     activated<C>(largest));
        }
    }
}

/// The columns of a convolution, cut into register blocks of `Size`.
template <frame_convolution C, std::size_t Size = C.block_columns()>
struct column_blocks {
    static constexpr std::size_t size = Size, count = ceil_div(C.columns(), size);

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
    /// The blocks [first_whole, last_whole) have all columns and no padding, and share one instantiation.
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
    /// body(columns, missing left, missing right, block) for all blocks; constants but the last.
    template <class Body>
    [[gnu::always_inline]] static void for_each(const Body& body) {
        const auto edge = [&](auto b) __attribute__((always_inline)) {
            body(constant<columns(b)>{}, constant<missing_left(b)>{}, constant<missing_right(b)>{}, b);
        };
        unroll<first_whole>(edge);
        for (std::size_t b = first_whole; b < last_whole; ++b)
            body(constant<size>{}, constant<0>{}, constant<0>{}, b);
        unroll<count - last_whole>([&](auto b)
                                       __attribute__((always_inline)) { edge(constant<last_whole + b>{}); });
    }
};

/// All blocks of `Rows` rows of outputs from row `y` on.
template <frame_convolution C, std::size_t Vectors, std::size_t Rows>
[[gnu::always_inline]] inline void convolve_rows(const float* input, const float* weights, const float* bias,
                                                 float* output, std::size_t y) {
    using blocks = column_blocks<C>;
    constexpr std::size_t footprint_rows = (Rows - 1) * C.window.stride.rows + C.window.kernel.rows;
    const std::size_t first = y * C.window.stride.rows; // row under the first tap, counted with the padding
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(first) - static_cast<std::ptrdiff_t>(C.window.top);
    float* const to = output + y / C.pool.rows * C.output_columns() * C.output_stride();
    const auto at = [&](std::size_t b) -> frame_block {
        return {.first_pixel = row * static_cast<std::ptrdiff_t>(C.window.input.columns) +
                               static_cast<std::ptrdiff_t>(b * blocks::size * C.window.stride.columns) -
                               static_cast<std::ptrdiff_t>(C.window.left),
                .first_row = C.window.top - std::min(C.window.top, first),
                .last_row =
                    std::min(footprint_rows, std::max(C.window.top + C.window.input.rows, first) - first)};
    };
    blocks::for_each([&](auto columns, auto left, auto right, std::size_t b) __attribute__((always_inline)) {
        convolve_block<C, Vectors, Rows, columns, left, right>(
            input, weights, bias, to + b * blocks::size / C.pool.columns * C.output_stride(), at(b));
    });
    activate_outputs<C>(to, ceil_div(Rows, C.pool.rows), C.output_columns(), Vectors * C.width());
}

/// Taps one by one. Possible for every convolution that is not grouped.
template <frame_convolution C>
struct direct_method : frame_method {
    static constexpr const char* name = "direct";
    static constexpr bool applicable = C.groups == 1 && C.fits_map();
    static constexpr std::uint64_t product_twentieths =
        C.vector_products() * direct_product * memory_penalty(C);
    static constexpr std::size_t packed_weights = pad_to_cache_line(C.weights());
    static constexpr std::size_t packed_elements = packed_weights + pad_to_cache_line(C.padded_filters());

    /// Weights in the order of use: blocks of vectors of filters, then [channel][kernel row][kernel column]
    /// [filter of the block]; zeros where there is no filter.
    template <class Weight>
    static constexpr void pack(const Weight& weight, const float* biases, float* to) {
        std::copy_n(biases, C.filters, to + packed_weights);
        pack_taps(weight, C.filters, C.padded_filters(), C.block_vectors() * C.width(),
                  C.window.input.channels, C.window.kernel, to);
    }
    static void run(const float* packed, const float* in, float* out, float*) noexcept {
        static_assert(!C.accumulates || C.pool == extent2d(1), "direct_method: a sum is not pooled");
        const float* const biases = packed + packed_weights;
        blocked<C.vectors(), C.block_vectors()>([&](auto vectors, std::size_t first_vector) {
            const std::size_t first = first_vector * C.width();
            blocked<C.rows(), C.block_rows()>([&](auto rows, std::size_t y) {
                convolve_rows<C, vectors, rows>(in, packed + first * C.taps(), biases + first, out + first,
                                                y);
            });
        });
    }
};

}}} // namespace tactnet::kernels
