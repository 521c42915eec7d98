#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/frame/direct.hpp>
#include <tactnet/kernels/method_list.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// Depthwise convolution of one frame: each filter sees one channel, as in separable convolutions (MobileNet,
// Howard et al., 2017). A tap multiplies a vector of channels with the vector of their filters. A block is
// some columns of outputs of one vector of filters, computed from the first row to the last: each row of the
// input is loaded once and added to all rows of outputs that it reaches, whose sums stay in registers until
// they are complete.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// One block of `Columns` outputs. `MissingLeft` and `MissingRight` of the columns under its taps are
/// padding. `input` is the first row of the image at the column of the first tap. Each sum adds bias, the
/// other term of a sum and taps in the order of their rows.
template <frame_convolution C, std::size_t Columns, std::size_t MissingLeft, std::size_t MissingRight>
[[gnu::flatten, gnu::noinline]] void convolve_depthwise_block(const float* input, const float* weights,
                                                              const float* bias, float* output) {
    using wide = sized_vector<float, C.width()>;
    constexpr std::size_t width = C.width(), out_rows = C.rows(), pooled = ceil_div(Columns, C.pool.columns);
    constexpr std::size_t kernel_rows = C.window.kernel.rows, kernel_columns = C.window.kernel.columns,
                          stride_rows = C.window.stride.rows, stride_columns = C.window.stride.columns;
    constexpr std::size_t under_columns = (Columns - 1) * stride_columns + kernel_columns;
    // Rows of outputs under way, and rows of the input after which the code repeats.
    constexpr std::size_t live = ceil_div(kernel_rows, stride_rows), period = live * stride_rows,
                          all = live * Columns;
    const auto at = [&](std::size_t y, std::size_t x) __attribute__((always_inline)) {
        return output + (y * C.output_columns() + x) * C.output_stride();
    };
    register_block<wide, live, Columns> sums;
    const wide start = load_as<wide>(bias);
#pragma GCC unroll 64
    for (std::size_t i = 0; i < all; ++i)
        sums[i / Columns][i % Columns] = start;
    [[maybe_unused]] std::array<wide, pooled> largest; // of the window of the pool so far

    // Row `row` of the input, counted with the padding; its place in the period is a constant.
    const auto add_row = [&](auto place, std::size_t row) __attribute__((always_inline)) {
        constexpr std::size_t begun = place / stride_rows % live;
        if constexpr (place % stride_rows == 0) {
            const std::size_t y = row / stride_rows;
#pragma GCC unroll 64
            for (std::size_t p = 0; p < Columns; ++p) {
                sums[begun][p] = start;
                if constexpr (C.accumulates)
                    if (y < out_rows)
                        sums[begun][p] = start + load_as<wide>(at(y, p));
            }
        }
        if (row >= C.window.top && row < C.window.top + C.window.input.rows) {
            const float* const from = input + (row - C.window.top) * C.window.input.columns * C.input_stride;
#pragma GCC unroll 64
            for (std::size_t c = MissingLeft; c + MissingRight < under_columns; ++c) {
                const wide x = load_as<wide>(from + c * C.input_stride);
#pragma GCC unroll 64
                for (std::size_t k = 0; k < kernel_rows; ++k)
#pragma GCC unroll 64
                    for (std::size_t tap = 0; tap < kernel_columns; ++tap)
                        if ((place + period - k) % stride_rows == 0 && c >= tap &&
                            (c - tap) % stride_columns == 0 && (c - tap) / stride_columns < Columns) {
                            wide& sum =
                                sums[(place + period - k) / stride_rows % live][(c - tap) / stride_columns];
                            sum = fused_multiply_add(
                                load_as<wide>(weights + (k * kernel_columns + tap) * width), x, sum);
                        }
            }
        }
        constexpr std::size_t last =
            place + period + 1 - kernel_rows; // row of the first tap, if this is the last
        if constexpr (last % stride_rows == 0) {
            if (row + 1 < kernel_rows)
                return;
            const std::size_t y = (row + 1 - kernel_rows) / stride_rows;
            const bool first_of_window = y % C.pool.rows == 0,
                       ends_window = (y + 1) % C.pool.rows == 0 || y + 1 == out_rows;
#pragma GCC unroll 64
            for (std::size_t o = 0; o < pooled; ++o) {
                const std::size_t left = o * C.pool.columns,
                                  across = std::min(C.pool.columns, Columns - left);
                wide value = sums[last / stride_rows % live][left];
#pragma GCC unroll 64
                for (std::size_t i = 1; i < across; ++i)
                    value = maximum_or_second(sums[last / stride_rows % live][left + i], value);
                if constexpr (C.pool.rows > 1) {
                    value = largest[o] = first_of_window ? value : maximum_or_second(value, largest[o]);
                    if (!ends_window)
                        continue;
                }
                store_as(at(y / C.pool.rows, o), activated<C>(value));
            }
        }
    };
    blocked<(out_rows - 1) * stride_rows + kernel_rows, period>([&](auto rows, std::size_t first) {
        unroll<rows>([&](auto place) __attribute__((always_inline)) { add_row(place, first + place); });
    });
}

/// As many groups as channels, with one filter each or several. If pixels of the input do not hold the
/// channels of the filters in whole vectors, they are copied first.
template <frame_convolution C>
struct depthwise_method : frame_method {
    static constexpr const char* name = "depthwise";
    static constexpr bool applicable = C.is_depthwise() && C.fits_map();
    static constexpr std::size_t filters_per_channel = C.filters / C.groups;
    /// Whether the input is copied: [pixel][filter], padded to whole vectors of filters.
    static constexpr bool copied = filters_per_channel > 1 || !C.input_in_vectors_of(C.width());
    static constexpr frame_convolution one_to_one = [] {
        frame_convolution c = C;
        c.window.input.channels = c.groups = C.filters;
        if (copied)
            c.input_stride = C.padded_filters(), c.input_offset_multiple = 0;
        return c;
    }();
    /// A copied number counts as half a multiply-add of a vector.
    static constexpr std::uint64_t product_twentieths =
        C.vector_products() * product + (copied ? C.window.input.area() * C.filters * product / 2 : 0);
    static constexpr std::size_t packed_weights = pad_to_cache_line(C.weights());
    static constexpr std::size_t packed_elements = packed_weights + pad_to_cache_line(C.padded_filters());
    static constexpr std::size_t workspace_elements =
        copied ? pad_to_cache_line(C.window.input.area() * C.padded_filters()) : 0;

    /// [vector of filters][kernel row][kernel column][filter of the vector].
    template <class Weight>
    static constexpr void pack(const Weight& weight, const float* biases, float* to) {
        std::copy_n(biases, C.filters, to + packed_weights);
        pack_taps(weight, C.filters, C.padded_filters(), C.width(), 1, C.window.kernel, to);
    }
    static void run(const float* packed, const float* in, float* out,
                    [[maybe_unused]] float* workspace) noexcept {
        static_assert(!C.accumulates || C.pool == extent2d(1), "depthwise_method: a sum is not pooled");
        if constexpr (copied) {
            float* to = workspace;
            for (std::size_t pixel = 0; pixel < C.window.input.area(); ++pixel, in += C.input_stride) {
                for (std::size_t channel = 0; channel < C.groups; ++channel, to += filters_per_channel)
                    std::fill_n(to, filters_per_channel, in[channel]);
                to = std::fill_n(to, C.padded_filters() - C.filters, 0.0f);
            }
            in = workspace;
        }
        using blocks = column_blocks<one_to_one, block_columns>;
        blocks::for_each([&](auto columns, auto left, auto right, std::size_t b) {
            const auto first = static_cast<std::ptrdiff_t>(b * blocks::size * C.window.stride.columns) -
                               static_cast<std::ptrdiff_t>(C.window.left);
            const float* const from = in + first * static_cast<std::ptrdiff_t>(one_to_one.input_stride);
            float* const to = out + b * blocks::size / C.pool.columns * C.output_stride();
            for (std::size_t f = 0; f < C.padded_filters(); f += C.width())
                convolve_depthwise_block<one_to_one, columns, left, right>(
                    from + f, packed + f * C.taps(), packed + packed_weights + f, to + f);
            activate_outputs<one_to_one>(to, C.output_rows(), ceil_div(columns, C.pool.columns));
        });
    }

private:
    /// Columns of a block: with as many sums in registers as were fastest for kernels of 3 × 3 and 5 × 5 (Zen
    /// 5).
    static constexpr std::size_t block_columns = [] {
        const std::size_t live = ceil_div(C.window.kernel.rows, C.window.stride.rows);
        return C.block_columns((vector_registers >= 32 ? 20 : 15) / live);
    }();
};

}}} // namespace tactnet::kernels
