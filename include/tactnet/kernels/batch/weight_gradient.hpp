#pragma once

#include <tactnet/kernels/batch/channel_gradient.hpp>
#include <tactnet/kernels/batch/convolution_gradient.hpp>
#include <tactnet/kernels/batch/tiles/tiled_gradient.hpp>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// The gradient of a convolution with respect to its weights in the way that takes least: by tiles, tap by
/// tap where channels fill vectors, else by sums across the lanes.
template <sliding_window W, std::size_t Filters, class T>
class weight_gradient {
    static constexpr batch_convolution ahead = batch_convolution::forward(W, Filters);
    using across_channels = channel_gradient_plan<W, Filters, T>;
    using across_samples = weight_gradient_plan<W, Filters, T>;
    static constexpr std::size_t weights = Filters * W.input.channels * W.kernel.area();

public:
    /// Outputs of a tile; 0: by taps.
    static constexpr extent2d tile = [] {
        constexpr std::size_t rows = across_channels::fits ? across_channels::tile_rows
                                                           : across_samples::tile_rows,
                              bands = (W.output_rows() + rows - 1) / rows;
        if (!group_tile_possible(ahead, 2))
            return extent2d(0);
        // Here sums that go to their totals are counted as one and a half: they lie apart.
        return cheapest_group_tile(
            cost_by_taps(ahead) + bands * weights * 3,
            [](extent2d outputs) { return tiled_gradient_possible<T>(ahead, outputs); },
            [](extent2d outputs) { return gradient_cost_by_tiles<T>(ahead, outputs); });
    }();
    static constexpr bool tiled = tile != extent2d(0); ///< whether by tiles

private:
    // The plan of the way that is taken.
    static constexpr auto plan_of = [] {
        if constexpr (tiled)
            return tiled_gradient_plan<W, Filters, tile, T>{};
        else if constexpr (across_channels::fits)
            return across_channels{};
        else
            return across_samples{};
    };
    using plan = decltype(plan_of());

public:
    /// Pieces of work that write different totals, and so may run on different threads.
    static constexpr std::size_t pieces = plan::pieces;
    /// Totals, in double.
    static constexpr std::size_t totals = [] {
        if constexpr (tiled)
            return plan::totals;
        else
            return weights;
    }();
    /// Elements that a thread needs beside.
    static constexpr std::size_t scratch = [] {
        if constexpr (tiled || across_channels::fits)
            return plan::scratch;
        else
            return std::size_t{0};
    }();

    /// sums += the gradient of one group, for the pieces [begin, end): `totals` of them, which begin as
    /// zeros. `beside` holds `scratch` elements.
    static void add(const T* input, const T* gradient, double* sums, T* beside, std::size_t begin,
                    std::size_t end) {
        if constexpr (tiled)
            add_tiled_gradient<W, Filters, tile>(input, gradient, sums, beside, begin, end);
        else if constexpr (across_channels::fits)
            add_channel_gradient<W, Filters>(input, gradient, sums, beside, begin, end);
        else
            add_weight_gradient<W, Filters>(input, gradient, sums, begin, end);
    }
    /// gradients[filter][channel][row][column] from those sums.
    static void finish(const double* sums, T* gradients) {
        if constexpr (tiled) {
            finish_tiled_gradient<W, Filters, tile>(sums, gradients);
        } else if constexpr (across_channels::fits) {
            for (std::size_t filter = 0; filter < Filters; ++filter)
                for (std::size_t channel = 0; channel < W.input.channels; ++channel)
                    for (std::size_t row = 0; row < W.kernel.rows; ++row)
                        for (std::size_t column = 0; column < W.kernel.columns; ++column)
                            *gradients++ = static_cast<T>(sums[plan::place(filter, channel, row, column)]);
        } else {
            for (std::size_t i = 0; i < weights; ++i)
                gradients[i] = static_cast<T>(sums[i]);
        }
    }
};

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
