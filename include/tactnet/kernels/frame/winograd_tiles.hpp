#pragma once

#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/frame/convolution.hpp>
#include <tactnet/tensor/alignment.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Winograd's convolutions F(2 × 2, 3 × 3) and F(2 × 2, 2 × 2) (Winograd, 1980; Lavin and Gray, 2016) of one
// frame, for deployed networks. A tile of 2 × 2 outputs takes 16 products a channel instead of 36, or 9
// instead of 16: input tiles and kernels are transformed, multiplied element by element (which is a matrix
// product over the channels for each element) and transformed back. All factors of the transforms are 1 and
// ½, so that little accuracy is lost. A tile of outputs is also a window of the pools in these networks.
//
// With d the input tile, g the kernel, y the outputs: y = Aᵀ [(G g Gᵀ) ∘ (Bᵀ d B)] A.
//
// clang-format off
//   3 × 3:   Bᵀ = 1  0 −1  0     G = 1  0  0     Aᵀ = 1  1  1  0
//                 0  1  1  0         ½  ½  ½          0  1 −1 −1
//                 0 −1  1  0         ½ −½  ½
//                 0  1  0 −1         0  0  1
//
//   2 × 2:   Bᵀ = 1 −1  0        G = 1  0        Aᵀ = 1  1  0
//                 0  1  0            1  1             0  1 −1
//                 0  1 −1            0  1
// clang-format on

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// How a convolution is cut into tiles.
template <frame_convolution C>
struct winograd_tiles {
    /// Rows and columns of an input tile, and of the transformed kernel.
    static constexpr std::size_t side = C.window.kernel.rows + 1, elements = side * side;
    static constexpr std::size_t rows = (C.rows() + 1) / 2, columns = (C.columns() + 1) / 2;
    static constexpr std::size_t count = rows * columns;

    static constexpr std::size_t channels = C.window.input.channels;
    static constexpr std::size_t input_width = lanes_for<float>(channels);
    static constexpr std::size_t input_vectors = (channels + input_width - 1) / input_width;
    static constexpr std::size_t input_stride = input_vectors * input_width;
    static constexpr std::size_t block_stride = C.block_vectors() * C.width();

    /// Tiles from the first transform to the last: as many as the first level of cache holds, where the
    /// kernels are small enough to be read for each of these bands; else all.
    static constexpr std::size_t band = [] {
        constexpr std::size_t of_a_tile = elements * (input_stride + block_stride) * sizeof(float);
        constexpr std::size_t most = std::max<std::size_t>(near_bytes / of_a_tile, 8);
        if (elements * channels * C.padded_filters() * sizeof(float) > near_weight_bytes)
            return count;
        const std::size_t bands = (count + most - 1) / most;
        return (count + bands - 1) / bands;
    }();
    /// Tiles in a register block, of so many in all: as many as registers allow, evenly spread.
    static constexpr std::size_t block_of(std::size_t tiles) {
        constexpr std::size_t most =
            std::max<std::size_t>((vector_registers == 32 ? 24 : 12) / C.block_vectors(), 1);
        return (tiles + (tiles + most - 1) / most - 1) / ((tiles + most - 1) / most);
    }
    /// The same in a band.
    static constexpr std::size_t block = block_of(band);

    /// Up to a whole cache line, so that what lies behind is aligned: the products, the memory of another
    /// frame.
    static constexpr std::size_t transformed_input = whole_lines(elements * band * input_stride);
    static constexpr std::size_t products = whole_lines(elements * band * block_stride);
    /// Elements of scratch memory.
    static constexpr std::size_t scratch = transformed_input + products;
    /// Elements of the transformed, packed kernels.
    static constexpr std::size_t weights = elements * channels * C.padded_filters();

    static constexpr bool possible =
        (C.window.kernel == extent(3) || C.window.kernel == extent(2)) && C.window.stride == extent(1) &&
        (C.pool == extent(1) || C.pool == extent(2)) && C.input_stride % input_width == 0 &&
        C.input_stride >= input_stride && C.input_multiple % input_width == 0;
    /// Whether vectors are so wide that transforms hide behind the products, but for about one operation
    /// each, as measured times of layers have it (benchmark_plan); else each load, addition and store counts.
    static constexpr bool wide = lanes<float> >= 8;
    /// Operations that the transform of an element adds to its products, for a vector of input channels.
    static constexpr std::size_t of_input = wide ? 1 : 4;
    /// The same of the transform back, for a vector of filters.
    static constexpr std::size_t of_output = wide ? 1 : 3;
    /// What a product by taps takes, in twentieths: with 16 wide registers a block has too few sums to hide
    /// how long a multiply-add takes, and reaches about 60 % of the peak.
    static constexpr std::size_t of_tap = wide && vector_registers < 32 ? 26 : 20;
    /// Whether fewer operations are needed than with taps on real pixels. Register blocks of few tiles wait
    /// for the weights.
    static constexpr bool pays = [] {
        if (!possible || block_of(count) * C.block_vectors() < 8)
            return false;
        const std::size_t direct = C.window.taps_on_pixels() * channels * C.vectors();
        const std::size_t tiled =
            elements * count * (channels * C.vectors() + of_input * input_vectors + of_output * C.vectors());
        return tiled * 21 < direct * of_tap;
    }();
};

/// Kernels as G g Gᵀ in the order of use: blocks of vectors of filters, then [element][channel][filter of the
/// block]. `weight(filter, channel, row, column)`.
template <frame_convolution C, class Weight>
constexpr void pack_winograd_weights(float* packed, Weight&& weight) {
    using tiles = winograd_tiles<C>;
    constexpr std::size_t kernel = tiles::side - 1, channels = tiles::channels;
    constexpr std::size_t block = C.block_vectors() * C.width();
    // A line of G times three or two numbers.
    const auto transformed = [](std::size_t line, const auto& g) {
        if (line == 0)
            return g[0];
        if (line == kernel)
            return g[kernel - 1];
        if constexpr (kernel == 2)
            return g[0] + g[1];
        else
            return 0.5 * (g[0] + (line == 1 ? g[1] : -g[1]) + g[2]);
    };
    for (std::size_t first = 0; first < C.padded_filters(); first += block) {
        const std::size_t count = std::min(block, C.padded_filters() - first);
        for (std::size_t channel = 0; channel < channels; ++channel)
            for (std::size_t f = 0; f < count; ++f) {
                std::array<std::array<double, kernel>, tiles::side> half{};
                for (std::size_t column = 0; column < kernel && first + f < C.filters; ++column) {
                    std::array<double, kernel> g{};
                    for (std::size_t row = 0; row < kernel; ++row)
                        g[row] = static_cast<double>(weight(first + f, channel, row, column));
                    for (std::size_t line = 0; line < tiles::side; ++line)
                        half[line][column] = transformed(line, g);
                }
                for (std::size_t e = 0; e < tiles::elements; ++e)
                    packed[(e * channels + channel) * count + f] =
                        static_cast<float>(transformed(e % tiles::side, half[e / tiles::side]));
            }
        packed += tiles::elements * channels * count;
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
