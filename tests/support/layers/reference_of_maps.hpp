#pragma once

// The references of layers that give a map another size. reference_of.hpp includes it.

#include <tactnet/layers.hpp>

#include <support/layers/reference.hpp>

namespace support {

template <class Spec>
struct reference_of;

template <tactnet::extent2d Factor, tactnet::interpolation Mode>
struct reference_of<tactnet::upsample<Factor, Mode>> {
    static reference_pointer on(extents3 in) {
        return reference_upsampling(in, in.rows * Factor.rows, in.columns * Factor.columns,
                                    Mode == tactnet::interpolation::bilinear);
    }
};
template <tactnet::extent2d Size, tactnet::interpolation Mode>
struct reference_of<tactnet::upsample_to<Size, Mode>> {
    static reference_pointer on(extents3 in) {
        return reference_upsampling(in, Size.rows, Size.columns, Mode == tactnet::interpolation::bilinear);
    }
};

template <std::size_t Filters, tactnet::extent2d Kernel, tactnet::extent2d Stride, tactnet::padding Padding,
          bool Bias>
struct reference_of<tactnet::transposed_conv2d<Filters, Kernel, Stride, Padding, Bias>> {
    static reference_pointer on(extents3 in) {
        const bool same = Padding.how == tactnet::padding::rule::same;
        // By `same` the output has size × stride pixels, and what is missing or too much is halved.
        const auto size = [&](std::size_t pixels, std::size_t kernel, std::size_t stride, std::size_t crop) {
            return same ? pixels * stride : (pixels - 1) * stride + kernel - crop;
        };
        const auto crop = [&](std::size_t kernel, std::size_t stride, std::size_t given) {
            return !same ? given : kernel > stride ? (kernel - stride) / 2 : 0;
        };
        const reference_enlargement geometry{
            in,
            Filters,
            size(in.rows, Kernel.rows, Stride.rows, Padding.top + Padding.bottom),
            size(in.columns, Kernel.columns, Stride.columns, Padding.left + Padding.right),
            Kernel.rows,
            Kernel.columns,
            Stride.rows,
            Stride.columns,
            crop(Kernel.rows, Stride.rows, Padding.top),
            crop(Kernel.columns, Stride.columns, Padding.left)};
        const auto window = tactnet::sliding_window::over({geometry.rows, geometry.columns, Filters}, Kernel,
                                                          Stride, Padding);
        using tactnet::kernels::batch_convolution;
        const auto tile_of = [](const batch_convolution& c) {
            const tactnet::extent2d tile = tactnet::kernels::best_tile(c);
            return tile_size{tile.rows, tile.columns};
        };
        const auto ahead = batch_convolution::backward(window, in.channels),
                   back = batch_convolution::forward(window, in.channels);
        return reference_transposed_convolution(
            geometry, Bias, {tile_of(ahead), tile_of(back), tactnet::kernels::winograd_possible(back, 2)});
    }
};

} // namespace support
