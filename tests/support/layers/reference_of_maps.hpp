#pragma once

// The references of layers that give a map another size. reference_of.hpp includes it.

#include <tactnet/kernels/batch/methods.hpp>
#include <tactnet/operators.hpp>

#include <support/layers/reference.hpp>
#include <support/layers/window_of.hpp>

namespace support {

template <class Spec>
struct reference_of;

inline reference_window window_over(extents3 in, tactnet::extent2d kernel, tactnet::extent2d stride,
                                    tactnet::padding around) {
    if (around.how == tactnet::padding::rule::same)
        return reference_window::same(in, kernel.rows, kernel.columns, stride.rows, stride.columns);
    const reference_window given{in,         kernel.rows,   kernel.columns, stride.rows, stride.columns,
                                 around.top, around.bottom, around.left,    around.right};
    return around.how == tactnet::padding::rule::ceil_mode ? given.completed() : given;
}

/// How the library computes a convolution in training.
inline reference_tiles tiles_of_convolution(tactnet::shape in, tactnet::extent2d kernel,
                                            tactnet::extent2d stride, tactnet::padding around,
                                            std::size_t filters, std::size_t groups) {
    auto window = tactnet::sliding_window::over(in, kernel, stride, around);
    window.input.channels /= groups;
    using tactnet::kernels::batch_convolution;
    const auto ahead = batch_convolution::forward(window, filters / groups),
               back = batch_convolution::backward(window, filters / groups);
    const auto tile_of = [](const batch_convolution& c) {
        const tactnet::extent2d tile = tactnet::kernels::best_tile(c);
        return tile_size{tile.rows, tile.columns};
    };
    return {tile_of(ahead), tile_of(back), tactnet::kernels::winograd_possible(ahead, 2)};
}

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

template <std::size_t Filters, tactnet::extent2d Kernel, tactnet::extent2d Dilation, tactnet::extent2d Stride,
          tactnet::padding Padding, tactnet::conv2d_options Options>
struct reference_of<tactnet::dilated_conv2d<Filters, Kernel, Dilation, Stride, Padding, Options>> {
    static reference_pointer on(extents3 in) {
        // The window of the dilated kernel gives the padding and counts the outputs.
        const reference_window reach = window_over(
            in, {(Kernel.rows - 1) * Dilation.rows + 1, (Kernel.columns - 1) * Dilation.columns + 1}, Stride,
            Padding);
        reference_window own = reach;
        own.kernel_rows = Kernel.rows, own.kernel_columns = Kernel.columns;
        // How the library lays the phases out.
        using tactnet::kernels::dilated_layout;
        const tactnet::sliding_window window{{in.rows, in.columns, in.channels},
                                             Kernel,
                                             Stride,
                                             reach.top,
                                             reach.bottom,
                                             reach.left,
                                             reach.right};
        const tactnet::extent2d outputs(reach.output_rows(), reach.output_columns());
        const auto trained =
            dilated_layout::of(window, Dilation, outputs, tactnet::kernels::phase_order::consecutive);
        const tactnet::sliding_window w = trained.window();
        return reference_dilated_convolution(
            {own, Dilation.rows, Dilation.columns, outputs.rows, outputs.columns, layout_of(trained, outputs),
             layout_of(dilated_layout::of(window, Dilation, outputs), outputs)},
            Filters, Options.groups, Options.bias,
            tiles_of_convolution(w.input, Kernel, w.stride, tactnet::pad(w.top, w.bottom, w.left, w.right),
                                 Filters, Options.groups));
    }

private:
    static reference_dilation::layout layout_of(const tactnet::kernels::dilated_layout& layout,
                                                tactnet::extent2d outputs) {
        reference_dilation::layout found{window_of(layout.window()), {}};
        for (std::size_t o = 0; o < outputs.area(); ++o)
            found.sums.push_back(layout.sum_of(o / outputs.columns, o % outputs.columns));
        return found;
    }
};

} // namespace support
