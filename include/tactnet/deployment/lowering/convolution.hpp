#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/deployment/steps/convolution.hpp>
#include <tactnet/layers/conv2d.hpp>

#include <cstddef>
#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// In place of a batch norm where none follows.
struct no_norm {
    explicit no_norm(const parameter_source&) {}
    [[nodiscard]] double factor(std::size_t) const { return 1; }
    [[nodiscard]] double shifted(std::size_t, double bias) const { return bias; }
};

/// What a convolution has taken up of the layers behind it.
struct convolution_epilogue {
    extent2d pool = 1; ///< window and stride of a max pool
    std::size_t pooled_rows = 0, pooled_columns = 0;
    bool rectified = false, adds = false;
    std::size_t map_stride = 0, map_offset = 0; ///< of a wider map that takes the output

    [[nodiscard]] constexpr bool pooled() const { return pooled_rows > 0; }
};

template <std::size_t MapStride, std::size_t MapOffset>
[[nodiscard]] constexpr convolution_epilogue at_place(convolution_epilogue behind) {
    behind.map_stride = MapStride, behind.map_offset = MapOffset;
    return behind;
}

/// A convolution with the batch norm, the max pool and the ReLU behind it. `Norm` gives the norm's constants.
template <class Place, class Norm = no_norm, convolution_epilogue Behind = convolution_epilogue{}>
struct lowered_convolution {
    using layer = typename Place::layer;
    static constexpr kernels::frame_convolution kernel{.window = layer::window,
                                                       .filters = layer::output.channels,
                                                       .input_stride = Place::input_stride,
                                                       .pool = Behind.pool,
                                                       .pooled_rows = Behind.pooled_rows,
                                                       .pooled_columns = Behind.pooled_columns,
                                                       .rectified = Behind.rectified,
                                                       .adds = Behind.adds,
                                                       .groups = layer::groups,
                                                       .map_stride = Behind.map_stride,
                                                       .map_offset = Behind.map_offset};
    using step = convolution_step<typename Place::format, kernel>;

    static void fold(const parameter_source& list, float* to) {
        const float* values = Place::parameters(list).values;
        const Norm norm(list);
        for (std::size_t w = 0; w < step::weights; ++w)
            to[w] = static_cast<float>(static_cast<double>(values[w]) * norm.factor(w / layer::fan_in));
        for (std::size_t f = 0; f < kernel.filters; ++f)
            to[step::weights + f] = static_cast<float>(
                norm.shifted(f, layer::has_bias ? static_cast<double>(values[step::weights + f]) : 0.0));
    }

    template <class Spec, class NextPlace>
    static constexpr auto fuse() {
        if constexpr (scales_channels<Spec, NextPlace>) {
            if constexpr (std::is_same_v<Norm, no_norm> && !Behind.pooled() && !Behind.rectified)
                return std::type_identity<
                    lowered_convolution<Place, channel_constants<Spec, NextPlace>, Behind>>{};
            else
                return not_fused{};
        } else if constexpr (takes_maximum<Spec, NextPlace>) {
            constexpr sliding_window pool = lowering<Spec>::template maximum<NextPlace>;
            if constexpr (!Behind.pooled() && side_by_side(pool))
                return std::type_identity<lowered_convolution<Place, Norm, with_pool(pool)>>{};
            else
                return not_fused{};
        } else if constexpr (rectifies<Spec>) {
            return std::type_identity<lowered_convolution<Place, Norm, with_relu()>>{};
        } else {
            return not_fused{};
        }
    }

    /// The last convolution of a residual block's main branch: what is added is added before anything else.
    template <bool Rectified>
        requires(!Behind.pooled() && !Behind.rectified)
    using adding =
        lowered_convolution<Place, Norm, convolution_epilogue{.rectified = Rectified, .adds = true}>;

    using as_output = lowered_convolution<typename Place::as_output, Norm, Behind>;

    /// Among the channels of a wider map, as a branch of a concatenation: where the filters fill vectors of
    /// four, which all instruction sets have.
    template <std::size_t MapStride, std::size_t MapOffset>
    static constexpr bool fits_slice = kernel.filters % 4 == 0 && MapOffset % 4 == 0 && MapStride % 4 == 0;
    template <std::size_t MapStride, std::size_t MapOffset>
    using slice = lowered_convolution<Place, Norm, at_place<MapStride, MapOffset>(Behind)>;

private:
    /// A max pool that a convolution can take along: windows side by side, none before the image, and no more
    /// pixels than a register block holds.
    static constexpr bool side_by_side(const sliding_window& w) {
        return w.kernel == w.stride && w.top == 0 && w.left == 0 &&
               2 * w.kernel.area() <= kernels::max_block_sums;
    }
    static constexpr convolution_epilogue with_pool(const sliding_window& pool) {
        convolution_epilogue more = Behind;
        more.pool = pool.kernel;
        more.pooled_rows = pool.output_rows(), more.pooled_columns = pool.output_columns();
        return more;
    }
    static constexpr convolution_epilogue with_relu() {
        convolution_epilogue more = Behind;
        more.rectified = true;
        return more;
    }
};

template <std::size_t Filters, extent2d Kernel, extent2d Stride, padding Padding, conv2d_options Options>
struct lowering<conv2d<Filters, Kernel, Stride, Padding, Options>> {
    template <class Place>
    using at = lowered_convolution<Place>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
