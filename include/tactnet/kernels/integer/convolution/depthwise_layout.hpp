#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/integer/interleave.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// How the depthwise method cuts a convolution, and lays out inputs and weights.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Multiplies, in each lane, a group of inputs by as many weights. Instruction sets without products of
/// groups multiply integers of 32 bits.
template <std::size_t Lanes, std::size_t Group = byte_products<Lanes>::group>
struct depthwise_products : byte_products<Lanes> {
    [[gnu::always_inline]] static int32_vec<Lanes>
    add(const int32_vec<Lanes>& sums, const std::int8_t* weights, const std::uint8_t* inputs) {
        using products = byte_products<Lanes>;
        return products::add(sums, load_bytes_as<typename products::weights>(weights),
                             load_bytes_as<typename products::inputs>(inputs));
    }
};
template <std::size_t Lanes>
struct depthwise_products<Lanes, 1> {
    using weight = std::int32_t;
    static constexpr std::size_t group = 1;
    static constexpr int offset = 0;
    [[gnu::always_inline]] static int32_vec<Lanes>
    add(const int32_vec<Lanes>& sums, const std::int8_t* weights, const std::uint8_t* inputs) {
        return sums + load_bytes_as<int32_vec<Lanes>>(weights) * load_bytes_as<int32_vec<Lanes>>(inputs);
    }
};

/// How a depthwise convolution is cut: blocks of four vectors of channels, bands of rows of outputs, register
/// blocks of columns.
template <frame_convolution C>
struct depthwise_integer_layout {
    static constexpr frame_convolution convolution = C;
    /// Lanes of a vector: the fewest with which there are as few blocks as with the widest.
    static constexpr std::size_t lanes = [] {
        const auto blocks = [](std::size_t l) { return ceil_div(C.padded_filters(), 4 * l); };
        std::size_t l = max_integer_lanes;
        while (l > 4 && blocks(l / 2) == blocks(max_integer_lanes))
            l /= 2;
        return l;
    }();
    static constexpr std::size_t block = 4 * lanes, ///< channels, and bytes of a vector
        blocks = ceil_div(C.padded_filters(), block);
    using products = depthwise_products<lanes>;
    static constexpr std::size_t group = products::group;

    /// Groups of input rows under `rows` rows of outputs.
    static constexpr std::size_t groups(std::size_t rows) {
        return ceil_div((rows - 1) * C.window.stride.rows + C.window.kernel.rows, group);
    }
    /// Whether a group has rows under a row of outputs.
    static constexpr bool overlap(std::size_t in_group, std::size_t row) {
        const std::size_t first = row * C.window.stride.rows;
        return in_group * group < first + C.window.kernel.rows && (in_group + 1) * group > first;
    }
    /// Columns of the input under all outputs.
    static constexpr std::size_t pitch =
        (C.columns() - 1) * C.window.stride.columns + C.window.kernel.columns;
    /// Vector instructions for a band of `rows` rows of outputs of a block: to load, interleave and store the
    /// input, then products.
    static constexpr std::size_t band_cost(std::size_t rows) {
        std::size_t overlaps = 0;
        for (std::size_t g = 0; g < groups(rows); ++g)
            for (std::size_t y = 0; y < rows; ++y)
                overlaps += overlap(g, y) ? 1 : 0;
        return 16 * groups(rows) * pitch +
               4 * (group == 4 ? 1 : 2) * overlaps * C.window.kernel.columns * C.columns();
    }
    /// Rows of a band: those of least cost per row, whose sums fit into registers.
    static constexpr std::size_t band = [] {
        const std::size_t most =
            std::min(std::max<std::size_t>(vector_registers >= 32 ? 4 : 2, C.pool.rows), C.rows());
        std::size_t best = std::min(C.pool.rows, C.rows());
        for (std::size_t rows = best; rows <= most; rows += C.pool.rows)
            if (band_cost(rows) * best < band_cost(best) * rows)
                best = rows;
        return best;
    }();
    /// Columns of a register block, evenly spread.
    static constexpr std::size_t block_columns = [] {
        const std::size_t step = C.pool.columns, sums = vector_registers >= 32 ? 8 : 4;
        const std::size_t most = std::max(sums / band / step * step, step);
        return round_up(ceil_div(C.columns(), ceil_div(C.columns(), most)), step);
    }();
    /// Bytes of the weights of a block: [group][row of the band][kernel column][vector][lane][input].
    static constexpr std::size_t block_weights = groups(band) * band * C.window.kernel.columns * 4 * block;
    /// Bytes of a band of a block: [group][column][vector][lane][input].
    static constexpr std::size_t staged = groups(band) * pitch * 4 * block;

    /// The place of a channel in arrays of filters, and of its weights.
    static constexpr std::size_t place(std::size_t channel) {
        return channel / block * block + interleaved_place<lanes>(channel % block);
    }
    /// Packs all weights; `weight(filter, channel of its group, row, column)`.
    template <class Weight>
    static constexpr void pack(const Weight& weight_at, std::int8_t* packed) {
        using weight = typename products::weight;
        for (std::size_t i = 0; i < block_weights / sizeof(weight) * blocks; ++i) {
            std::size_t rest = i; // the index, digit by digit from the innermost
            const auto next = [&rest](std::size_t count) {
                const std::size_t index = rest % count;
                rest /= count;
                return index;
            };
            const std::size_t input = next(group), lane = next(lanes), vector = next(4),
                              column = next(C.window.kernel.columns), y = next(band),
                              in_group = next(groups(band)),
                              filter = rest * block + lane / 4 * 16 + vector * 4 + lane % 4,
                              row = in_group * group + input - y * C.window.stride.rows; // may wrap around
            const bool there = filter < C.filters && row < C.window.kernel.rows;
            const auto bytes = tactnet::detail::bits_as<std::array<std::int8_t, sizeof(weight)>>(
                weight{there ? weight_at(filter, std::size_t{0}, row, column) : std::int8_t{0}});
            packed = std::copy(bytes.begin(), bytes.end(), packed);
        }
    }
};

}}} // namespace tactnet::kernels
