#pragma once

#include <tactnet/kernels/batch/convolution.hpp>
#include <tactnet/kernels/batch/tiles/tile_weights.hpp>
#include <tactnet/kernels/batch/tiles/tiled_convolution.hpp>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// A convolution of one group of samples in the way that takes least: by tiles, or tap by tap.
template <batch_convolution C, class T>
struct lane_convolution {
    static constexpr extent2d tile = best_group_tile(C); ///< 0: by taps
    static constexpr bool tiled = tile != extent2d(0);   ///< whether by tiles
    /// Elements of the packed weights.
    static constexpr std::size_t weights = [] {
        if constexpr (tiled)
            return tiled_convolution<C, tile, T>::weights;
        else
            return C.input.channels * C.output.channels * C.kernel.area();
    }();
    /// Elements that a thread needs beside.
    static constexpr std::size_t scratch = [] {
        if constexpr (tiled)
            return tiled_convolution<C, tile, T>::scratch;
        else
            return std::size_t{0};
    }();

    /// Weights in the order of use. `weight(output, input, row, column)` tells each value.
    template <class Weight>
    static void pack(T* packed, Weight&& weight) {
        if constexpr (tiled)
            pack_tile_weights<C, tile>(packed, weight);
        else
            pack_weights<C>(packed, weight);
    }
    /// output = bias + convolution of input and weights. `bias` may be null; `beside` holds
    /// `scratch` elements.
    static void run(const T* input, const T* packed, const T* bias, T* output, T* beside) {
        if constexpr (tiled)
            correlate_by_tiles<C, tile>(input, packed, bias, output, beside);
        else
            correlate<C>(input, packed, bias, output);
    }
};

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
