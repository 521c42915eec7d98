#pragma once

#include <tactnet/kernels/caches.hpp>
#include <tactnet/kernels/frame/tile_choice.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>
#include <tactnet/tensor/alignment.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Winograd's convolutions of one frame in two dimensions (simd/tile_lines.hpp has their lines), for deployed
// networks. A tile of 2 × 2 outputs of a kernel of 3 × 3 takes 16 products a channel instead of 36, one of 4
// × 4 takes 36 instead of 144: input tiles and kernels are transformed, multiplied element by element (which
// is a matrix product over the channels for each element) and transformed back. With d the input tile, g the
// kernel, y the outputs: y = Aᵀ [(G g Gᵀ) ∘ (Bᵀ d B)] A. A tile of outputs holds whole windows of the pools
// in these networks.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// How a convolution is cut into tiles of so many rows and columns of outputs, those of several frames in one
/// list. Nothing of the packed kernels depends on the number of frames.
template <frame_convolution C, extent2d Outputs = best_tile(C), std::size_t Frames = 1>
struct winograd_tiles {
    static_assert(
        tile_possible(C, Outputs),
        "winograd_tiles: this convolution has no such tile; best_tile gives 0 where taps take fewer "
        "operations");
    /// Rows and columns of an input tile, and of the transformed kernel.
    static constexpr extent2d side = tile_side(C, Outputs);
    static constexpr std::size_t elements = side.area(); ///< of an input tile
    static constexpr std::size_t columns = (C.columns() + Outputs.columns - 1) / Outputs.columns;
    static constexpr std::size_t of_frame = tile_count(C, Outputs); ///< tiles of one
    static constexpr std::size_t count = Frames * of_frame;

    static constexpr std::size_t channels = C.window.input.channels;
    static constexpr std::size_t input_width = lanes_for<float>(channels);
    static constexpr std::size_t input_vectors = (channels + input_width - 1) / input_width;
    static constexpr std::size_t input_stride = input_vectors * input_width;
    /// Vectors of filters in a register block: more where there are few tiles to fill it.
    static constexpr std::size_t block_vectors = tile_block_vectors(C, of_frame);
    static constexpr std::size_t block_stride = block_vectors * C.width();

    /// Tiles from the first transform to the last: as many as the first level of cache holds, where the
    /// kernels are small enough to be read for each of these bands; else all.
    static constexpr std::size_t band = [] {
        constexpr std::size_t of_a_tile = elements * (input_stride + block_stride) * sizeof(float);
        constexpr std::size_t most = std::max<std::size_t>(l1_map_bytes / of_a_tile, 8);
        if (elements * channels * C.padded_filters() * sizeof(float) > l2_weight_bytes)
            return count;
        const std::size_t bands = (count + most - 1) / most;
        return (count + bands - 1) / bands;
    }();
    /// Tiles in a register block.
    static constexpr std::size_t block = tiles_of_block(band, block_vectors);

    /// Up to a whole cache line, so that what lies behind is aligned: the products, the memory of another
    /// frame.
    static constexpr std::size_t transformed_input = whole_lines(elements * band * input_stride);
    static constexpr std::size_t products = whole_lines(elements * band * block_stride);
    /// Elements of scratch memory.
    static constexpr std::size_t scratch = transformed_input + products;
    /// Elements of the transformed, packed kernels.
    static constexpr std::size_t weights = elements * channels * C.padded_filters();
};

/// Frames whose tiles make one list, where there are so many frames: few tiles are done before their kernels
/// have come, which more of them share. Not where all that is transformed would leave the nearest levels:
/// with an eighth of the second one list was faster, with more it was slower (Zen 4).
template <frame_convolution C, extent2d Outputs = best_tile(C)>
inline constexpr std::size_t
    frames_by_tiles = winograd_tiles<C, Outputs, 4>::scratch * sizeof(float) <= l2_cache_bytes / 8 ? 4 : 1;

/// Kernels as G g Gᵀ in the order of use, into zeros: blocks of vectors of filters, then [element][channel]
/// [filter of the block]. `weight(filter, channel, row, column)`.
template <frame_convolution C, extent2d Outputs = best_tile(C), class Weight>
constexpr void pack_winograd_weights(float* packed, Weight&& weight) {
    using tiles = winograd_tiles<C, Outputs>;
    constexpr std::size_t kernel = C.window.kernel.rows, channels = tiles::channels;
    constexpr extent2d side = tiles::side;
    for (std::size_t first = 0; first < C.padded_filters(); first += tiles::block_stride) {
        const std::size_t count = std::min(tiles::block_stride, C.padded_filters() - first);
        for (std::size_t channel = 0; channel < channels; ++channel)
            for (std::size_t f = 0; f < count && first + f < C.filters; ++f) {
                std::array<std::array<double, kernel>, side.rows> half{};
                for (std::size_t column = 0; column < kernel; ++column) {
                    std::array<double, kernel> g{};
                    for (std::size_t row = 0; row < kernel; ++row)
                        g[row] = static_cast<double>(weight(first + f, channel, row, column));
                    const std::array<double, side.rows> line = detail::tile_kernel_line<side.rows>(g);
                    for (std::size_t row = 0; row < side.rows; ++row)
                        half[row][column] = line[row];
                }
                std::size_t place = channel * count + f;
                for (const std::array<double, kernel>& row : half)
                    for (const double element : detail::tile_kernel_line<side.columns>(row)) {
                        packed[place] = static_cast<float>(element);
                        place += channels * count;
                    }
            }
        packed += tiles::elements * channels * count;
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
