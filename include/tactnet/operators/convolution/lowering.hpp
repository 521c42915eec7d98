#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/convolution/layer.hpp>
#include <tactnet/operators/convolution/step.hpp>

#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The constants of a convolution without a batch norm after it.
struct no_norm {
    explicit no_norm(const parameter_source&) {}
    [[nodiscard]] double factor(std::size_t) const { return 1; }
    [[nodiscard]] double shifted(std::size_t, double bias) const { return bias; }
};

/// What a convolution fuses, apart from a batch norm.
struct convolution_epilogue {
    extent2d pool = 1; ///< window and stride of a max pool
    std::size_t pooled_rows = 0, pooled_columns = 0;
    const kernels::fused_activation* activation = &kernels::no_activation;
    bool accumulates = false;
    std::size_t map_stride = 0, map_offset = 0; ///< of a wider map with a slice for the output

    [[nodiscard]] constexpr bool pooled() const { return pooled_rows > 0; }
    [[nodiscard]] constexpr convolution_epilogue with_pool(const sliding_window& window) const {
        convolution_epilogue more = *this;
        more.pool = window.kernel;
        more.pooled_rows = window.output_rows(), more.pooled_columns = window.output_columns();
        return more;
    }
    [[nodiscard]] constexpr convolution_epilogue with(const kernels::fused_activation* function) const {
        convolution_epilogue more = *this;
        more.activation = function;
        return more;
    }
    /// Whether a max pool may follow: computed before the function, it must give the same.
    [[nodiscard]] constexpr bool allows_pool() const {
        return !pooled() && (!activation->exists || activation->monotonic);
    }
    [[nodiscard]] constexpr convolution_epilogue in_slice(std::size_t stride, std::size_t offset) const {
        convolution_epilogue more = *this;
        more.map_stride = stride, more.map_offset = offset;
        return more;
    }
};

/// A convolution with the batch norm, the max pool and the activation function after it. `Norm` has the
/// norm's constants.
template <class Place, class Norm = no_norm, convolution_epilogue Epilogue = convolution_epilogue{}>
struct lowered_convolution {
    using layer = typename Place::layer;
    static constexpr kernels::frame_convolution kernel{.window = layer::window,
                                                       .filters = layer::output.channels,
                                                       .input_stride = Place::input_stride,
                                                       .pool = Epilogue.pool,
                                                       .pooled_rows = Epilogue.pooled_rows,
                                                       .pooled_columns = Epilogue.pooled_columns,
                                                       .activation = Epilogue.activation,
                                                       .accumulates = Epilogue.accumulates,
                                                       .groups = layer::groups,
                                                       .map_stride = Epilogue.map_stride,
                                                       .map_offset = Epilogue.map_offset};
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
            if constexpr (std::is_same_v<Norm, no_norm> && !Epilogue.pooled() && !Epilogue.activation->exists)
                return std::type_identity<
                    lowered_convolution<Place, channel_constants<Spec, NextPlace>, Epilogue>>{};
            else
                return not_fused{};
        } else if constexpr (pools_maximum<Spec, NextPlace>) {
            constexpr sliding_window pool = lowering<Spec>::template maximum<NextPlace>;
            if constexpr (Epilogue.allows_pool() && fusible(pool))
                return std::type_identity<lowered_convolution<Place, Norm, Epilogue.with_pool(pool)>>{};
            else
                return not_fused{};
        } else if constexpr (activates<Spec, typename Place::format, layer::output.channels>) {
            // A ReLU changes nothing after another one.
            constexpr const kernels::fused_activation* next = lowering<Spec>::activation;
            if constexpr (!Epilogue.activation->exists || (Epilogue.activation->rectifies && next->rectifies))
                return std::type_identity<lowered_convolution<Place, Norm, Epilogue.with(next)>>{};
            else
                return not_fused{};
        } else {
            return not_fused{};
        }
    }

    /// The last convolution of a residual block's main branch: the sum comes before everything else.
    template <const kernels::fused_activation* Activation>
        requires(!Epilogue.pooled() && !Epilogue.activation->exists)
    using adding =
        lowered_convolution<Place, Norm, convolution_epilogue{.activation = Activation, .accumulates = true}>;

    using as_output = lowered_convolution<typename Place::as_output, Norm, Epilogue>;

    /// A slice must consist of vectors of four, which all instruction sets have.
    template <std::size_t MapStride, std::size_t MapOffset>
    static constexpr bool fits_slice = kernel.filters % 4 == 0 && MapOffset % 4 == 0 && MapStride % 4 == 0;
    template <std::size_t MapStride, std::size_t MapOffset>
    using slice = lowered_convolution<Place, Norm, Epilogue.in_slice(MapStride, MapOffset)>;

private:
    /// Whether a convolution can fuse a max pool: windows are disjoint, none begins before the image, and
    /// none has more pixels than a register block of every instruction set holds. The steps of a network, by
    /// whose names files are read, must not depend on the instruction set.
    static constexpr bool fusible(const sliding_window& w) {
        return w.kernel == w.stride && w.top == 0 && w.left == 0 &&
               w.kernel.area() <= kernels::frame_convolution::max_pool_area;
    }
};

template <std::size_t Filters, extent2d Kernel, extent2d Stride, padding Padding, conv2d_options Options>
struct lowering<conv2d<Filters, Kernel, Stride, Padding, Options>> {
    template <class Place>
    using at = lowered_convolution<Place>;
};

}} // namespace tactnet
