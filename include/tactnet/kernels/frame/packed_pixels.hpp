#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/method_list.hpp>
#include <tactnet/kernels/simd/row_vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// Convolution of an image of one channel with few filters, the first layer of most networks: where all
// filters fill half of a vector or less, several neighbouring pixels share one. The rows under a kernel are
// broadcast first, each number as often as a pixel has lanes. A vector from anywhere in such a row then holds
// the inputs of neighbouring pixels under one tap, each repeated for its filters. Sums are bit-identical with
// those of direct_method, apart from the sign of zero: padding to the left and right of the image is
// computed.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// A convolution cut into vectors of several pixels. Sizes only.
template <frame_convolution C>
struct packed_pixels {
    /// Lanes of a pixel, and pixels of a vector.
    static constexpr std::size_t width = C.width(), pixels = std::max<std::size_t>(lanes<float> / width, 1);
    /// Whether several pixels fit a vector, and the kernel below supports the rest.
    static constexpr bool applicable =
        pixels > 1 &&
        C.vectors() == 1 && C.window.input.channels == 1 && C.groups == 1 && C.window.stride == extent2d(1) &&
        !C.accumulates && C.map_stride == 0 && pixels % C.pool.columns == 0 && C.columns() >= pixels;

    static constexpr std::size_t vectors = ceil_div(C.columns(), pixels); ///< of a row of outputs
    static constexpr std::size_t rows = C.block_rows(); ///< of outputs that are computed together
    /// Sums in a register block, so that a third of the registers is left to inputs and weights: with 12 to
    /// 24 of 32 the times are within 9 % (Zen 5), with 20 they are the least.
    static constexpr std::size_t max_sums = vector_registers >= 32 ? 20 : 10;
    /// Vectors of a row in a register block, evenly spread.
    static constexpr std::size_t block = [] {
        constexpr std::size_t most = std::max<std::size_t>(max_sums / rows, 1);
        constexpr std::size_t blocks = ceil_div(vectors, most);
        return ceil_div(vectors, blocks);
    }();

    /// Rows of the input under a block, kept broadcast.
    static constexpr std::size_t footprint_rows = rows - 1 + C.window.kernel.rows;
    /// Elements of one of them.
    static constexpr std::size_t row_elements = (vectors * pixels + C.window.kernel.columns - 1) * width;
};

/// Broadcasts each number of a row of the image to all lanes of a pixel, with zeros for the padding.
template <frame_convolution C>
void broadcast_row(const float* row, float* to) {
    using plan = packed_pixels<C>;
    using narrow = sized_vector<float, plan::width>;
    constexpr std::size_t count = plan::row_elements / plan::width, left = C.window.left;
    constexpr std::size_t inside = std::min(C.window.input.columns, count - left);
    for (std::size_t c = 0; c < left; ++c)
        store_as(to + c * plan::width, narrow(0.0f));
#pragma GCC unroll 8
    for (std::size_t c = 0; c < inside; ++c)
        store_as(to + (left + c) * plan::width, narrow(row[c * C.input_stride]));
    for (std::size_t c = left + inside; c < count; ++c)
        store_as(to + c * plan::width, narrow(0.0f));
}

/// One register block: `Rows` × `Vectors` vectors of outputs before pooling, of which the first `Columns`
/// pixels of each row count. `rows` are those under its taps, null where there is padding.
template <frame_convolution C, std::size_t Rows, std::size_t Vectors, std::size_t Columns>
[[gnu::flatten, gnu::noinline]] void
convolve_packed_block(const std::array<const float*, packed_pixels<C>::footprint_rows>& rows,
                      const float* weights, const float* biases, float* output) {
    using plan = packed_pixels<C>;
    using narrow = sized_vector<float, plan::width>;
    constexpr std::size_t width = plan::width, pixels = plan::pixels;
    constexpr extent2d kernel = C.window.kernel;
    constexpr std::size_t footprint_rows = Rows - 1 + kernel.rows;
    constexpr std::size_t under_columns = (Vectors - 1) * pixels + kernel.columns;

    register_block<vector<float>, Rows, Vectors> sums;
    const auto start = load<float>(biases);
#pragma GCC unroll 64
    for (std::size_t y = 0; y < Rows; ++y)
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v)
            sums[y][v] = start;

#pragma GCC unroll 64
    for (std::size_t r = 0; r < footprint_rows; ++r) {
        if (rows[r] == nullptr)
            continue;
#pragma GCC unroll 64
        for (std::size_t c = 0; c < under_columns; ++c) {
            auto x = load_unaligned<vector<float>>(rows[r] + c * width);
            keep_in_register(x);
#pragma GCC unroll 64
            for (std::size_t y = 0; y < Rows; ++y)
#pragma GCC unroll 64
                for (std::size_t tap = 0; tap < kernel.columns; ++tap)
                    if (r >= y && r - y < kernel.rows && c >= tap && (c - tap) % pixels == 0 &&
                        (c - tap) / pixels < Vectors)
                        sums[y][(c - tap) / pixels] = fused_multiply_add(
                            load<float>(weights + ((r - y) * kernel.columns + tap) * lanes<float>), x,
                            sums[y][(c - tap) / pixels]);
        }
    }

    // Pools take rows first, as whole vectors, then the pixels of these. A monotonic function comes between:
    // its vectors are wider there.
    constexpr bool function_first = C.activation->exists && (C.pool.columns == 1 || C.activation->monotonic);
    constexpr std::size_t pooled_rows = ceil_div(Rows, C.pool.rows),
                          pooled_columns = ceil_div(Columns, C.pool.columns);
    alignas(vector_alignment) std::array<float, pooled_rows * Vectors * lanes<float>> map;
#pragma GCC unroll 64
    for (std::size_t o = 0; o < pooled_rows; ++o)
#pragma GCC unroll 64
        for (std::size_t v = 0; v < Vectors; ++v) {
            auto largest = sums[o * C.pool.rows][v];
            const std::size_t end = std::min(Rows, (o + 1) * C.pool.rows);
#pragma GCC unroll 64
            for (std::size_t y = o * C.pool.rows + 1; y < end; ++y)
                largest = maximum_or_second(sums[y][v], largest);
            if constexpr (function_first)
                largest = activated<C>(largest);
            store(map.data() + (o * Vectors + v) * lanes<float>, largest);
        }
#pragma GCC unroll 64
    for (std::size_t o = 0; o < pooled_rows * pooled_columns; ++o) {
        const std::size_t row = o / pooled_columns, left = o % pooled_columns * C.pool.columns;
        const float* const from = map.data() + (row * Vectors * pixels + left) * width;
        const std::size_t across = std::min(C.pool.columns, Columns - left);
        auto largest = load_as<narrow>(from);
#pragma GCC unroll 64
        for (std::size_t i = 1; i < across; ++i)
            largest = maximum_or_second(load_as<narrow>(from + i * width), largest);
        if constexpr (!function_first)
            largest = activated<C>(largest);
        store_as(output + (row * C.output_columns() + o % pooled_columns) * width, largest);
    }
}

template <frame_convolution C>
struct packed_pixels_method : frame_method {
    using plan = packed_pixels<C>;
    static constexpr const char* name = "packed pixels";
    static constexpr bool applicable = plan::applicable;
    static constexpr std::uint64_t product_twentieths =
        C.vector_products() * product * memory_penalty(C) / plan::pixels;
    static constexpr std::size_t packed_weights =
        pad_to_cache_line(C.window.kernel.area() * plan::pixels * plan::width);
    static constexpr std::size_t packed_elements =
        packed_weights + pad_to_cache_line(plan::pixels * plan::width);
    static constexpr std::size_t workspace_elements =
        pad_to_cache_line(plan::footprint_rows * plan::row_elements);

    /// [kernel row][kernel column][pixel of a vector][filter], the same for each pixel, as are biases.
    template <class Weight>
    static constexpr void pack(const Weight& weight, const float* biases, float* to) {
        for (std::size_t pixel = 0; pixel < plan::pixels; ++pixel)
            std::copy_n(biases, C.filters, to + packed_weights + pixel * plan::width);
        const auto of_lane = [&](std::size_t lane, std::size_t channel, std::size_t row, std::size_t column) {
            const std::size_t f = lane % plan::width;
            return f < C.filters ? weight(f, channel, row, column) : 0.0f;
        };
        constexpr std::size_t all = plan::pixels * plan::width;
        pack_taps(of_lane, all, all, all, 1, C.window.kernel, to);
    }
    static void run(const float* packed, const float* input, float* output, float* workspace) noexcept {
        constexpr std::size_t height = C.window.input.rows;
        std::size_t done = 0; // rows of the image that are broadcast
        const auto some_rows = [&](auto rows, std::size_t y) {
            std::array<const float*, plan::footprint_rows> under{};
            for (std::size_t r = 0; r < rows - 1 + C.window.kernel.rows; ++r) {
                if (y + r < C.window.top || y + r - C.window.top >= height)
                    continue;
                const std::size_t row = y + r - C.window.top;
                float* const place = workspace + row % plan::footprint_rows * plan::row_elements;
                if (row >= done) {
                    broadcast_row<C>(input + row * C.window.input.columns * C.input_stride, place);
                    done = row + 1;
                }
                under[r] = place;
            }
            float* const to = output + y / C.pool.rows * C.output_columns() * plan::width;
            blocked<plan::vectors, plan::block>([&](auto vectors, std::size_t first) {
                const auto columns = [&](auto count) {
                    convolve_packed_block<C, rows, vectors, count>(under, packed, packed + packed_weights,
                                                                   to + first * plan::pixels /
                                                                            C.pool.columns * plan::width);
                };
                constexpr std::size_t rest = C.columns() - (plan::vectors - vectors) * plan::pixels;
                if (first + vectors == plan::vectors)
                    columns(constant<rest>{});
                else
                    columns(constant<vectors * plan::pixels>{});
                for (auto& row : under)
                    if (row != nullptr)
                        row += vectors * plan::pixels * plan::width;
            });
        };
        for (std::size_t y = 0; y + plan::rows <= C.rows(); y += plan::rows)
            some_rows(constant<plan::rows>{}, y);
        if constexpr (C.rows() % plan::rows != 0)
            some_rows(constant<C.rows() % plan::rows>{}, C.rows() / plan::rows * plan::rows);
        // Wide vectors would wait for the narrow ones that were just stored, so not row by row.
        activate_outputs<C>(output, C.output_rows(), C.output_columns());
    }
};

}}} // namespace tactnet::kernels
