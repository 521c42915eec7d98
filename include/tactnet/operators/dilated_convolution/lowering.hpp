#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/operators/convolution/lowering.hpp>
#include <tactnet/operators/dilated_convolution/layer.hpp>
#include <tactnet/operators/dilated_convolution/step.hpp>
#include <tactnet/operators/sequence/step.hpp>

#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Rejects the frame as the input where it has a format of its own.
template <bool ReadsFrame>
[[nodiscard]] constexpr std::size_t stride_of_map(std::size_t stride) {
    static_assert(!ReadsFrame, "deploy: in this number format a network cannot begin with a dilated "
                               "convolution: a convolution, a dense layer or a batch norm must come first");
    return stride;
}

/// The place of the convolution of the phases, with the parameters of the dilated one.
template <class Place>
struct phase_place : Place {
    using format = typename Place::format::hidden_format;
    using layer = typename Place::layer::deployed_convolution;
};

} // namespace detail

/// A dilated convolution with the batch norm and the activation function after it: its phases in one
/// map (kernels/dilated_axis.hpp), one convolution without dilation, its outputs in their places.
template <class Place, class Convolution = lowered_convolution<detail::phase_place<Place>>>
struct lowered_dilated_convolution {
    using layer = typename Place::layer;
    using format = typename Place::format::hidden_format;
    using splitting =
        phase_splitting_step<format, layer::window, layer::dilation, layer::outputs,
                             detail::stride_of_map<!std::is_same_v<format, typename Place::format>>(
                                 Place::input_stride)>;
    using convolution = typename Convolution::step;
    using step = step_chain<splitting, convolution,
                            phase_merging_step<format, layer::window, layer::dilation, layer::outputs,
                                               layer::output.channels, convolution::output_stride>>;

    static void fold(const parameter_source& list, float* to) {
        Convolution::fold(list, to + splitting::folded_elements);
    }

    template <class Spec, class NextPlace>
    static constexpr auto fuse() {
        if constexpr (!pools_maximum<Spec, NextPlace> && fuses<Convolution, Spec, NextPlace>)
            return std::type_identity<lowered_dilated_convolution<
                Place, typename decltype(Convolution::template fuse<Spec, NextPlace>())::type>>{};
        else
            return not_fused{};
    }
};

template <std::size_t Filters, extent2d Kernel, extent2d Dilation, extent2d Stride, padding Padding,
          conv2d_options Options>
struct lowering<dilated_conv2d<Filters, Kernel, Dilation, Stride, Padding, Options>> {
    template <class Place>
    using at = lowered_dilated_convolution<Place>;
};

namespace detail {

/// A transposed convolution along one axis, as convolutions of stride 1: output o is at position o + crop =
/// stride × q + phase, a sum over the taps phase, phase + stride, … of the kernel, of which tap t reads input
/// q − t.
struct phase_axis {
    std::size_t taps;          ///< of each phase; those that the kernel does not have are zero
    std::size_t outputs;       ///< all q
    std::size_t before, after; ///< padding of the input
    std::size_t skipped;       ///< positions before the first output, from its q on

    static constexpr phase_axis of(std::size_t size, std::size_t output, std::size_t kernel,
                                   std::size_t stride, std::size_t crop) {
        const std::size_t taps = ceil_div(kernel, stride), first = crop / stride,
                          last = (output - 1 + crop) / stride;
        return {taps, last + 1 - first, taps - 1 - first, last + 1 - size, crop % stride};
    }
};

} // namespace detail

/// A transposed convolution with the batch norm and the activation function after it: one convolution whose
/// filters are those of all phases of the stride, then the interleaving of the phases.
template <class Place, class Norm = no_norm,
          const kernels::fused_activation* Activation = &kernels::no_activation>
struct lowered_transposed_convolution {
    using layer = typename Place::layer;
    static constexpr extent2d kernel = layer::window.kernel, stride = layer::window.stride;
    static constexpr detail::phase_axis down = detail::phase_axis::of(layer::input.rows, layer::output.rows,
                                                                      kernel.rows, stride.rows,
                                                                      layer::window.top),
                                        along = detail::phase_axis::of(layer::input.columns,
                                                                       layer::output.columns, kernel.columns,
                                                                       stride.columns, layer::window.left);
    static constexpr kernels::frame_convolution phases{
        .window =
            {layer::input, {down.taps, along.taps}, 1, down.before, down.after, along.before, along.after},
        .filters = stride.area() * layer::output.channels,
        .input_stride = Place::input_stride,
        .activation = Activation};
    using convolution = convolution_step<typename Place::format, phases>;
    using step = std::conditional_t<
        stride == extent2d(1), convolution,
        step_chain<convolution,
                   phase_interleaving_step<
                       typename convolution::format, shape{down.outputs, along.outputs, phases.filters},
                       stride, extent2d(down.skipped, along.skipped),
                       extent2d(layer::output.rows, layer::output.columns), convolution::output_stride>>>;

    static void fold(const parameter_source& list, float* to) {
        const float* const values = Place::parameters(list).values;
        const Norm norm(list);
        constexpr std::size_t filters = layer::output.channels;
        for (std::size_t p = 0; p < phases.filters; ++p) {
            const std::size_t f = p % filters, row = p / filters / stride.columns,
                              column = p / filters % stride.columns;
            for (std::size_t c = 0; c < layer::input.channels; ++c)
                for (std::size_t i = down.taps; i-- > 0;)
                    for (std::size_t j = along.taps; j-- > 0;) {
                        const std::size_t y = row + stride.rows * i, x = column + stride.columns * j;
                        const bool there = y < kernel.rows && x < kernel.columns;
                        const std::size_t at =
                            there ? ((c * filters + f) * kernel.rows + y) * kernel.columns + x : 0;
                        *to++ = there ? static_cast<float>(static_cast<double>(values[at]) * norm.factor(f))
                                      : 0.0f;
                    }
        }
        for (std::size_t p = 0; p < phases.filters; ++p) {
            const std::size_t f = p % filters;
            *to++ = static_cast<float>(
                norm.shifted(f, layer::has_bias ? static_cast<double>(values[layer::weights + f]) : 0.0));
        }
    }

    template <class Spec, class NextPlace>
    static constexpr auto fuse() {
        if constexpr (scales_channels<Spec, NextPlace>) {
            if constexpr (std::is_same_v<Norm, no_norm> && !Activation->exists)
                return std::type_identity<
                    lowered_transposed_convolution<Place, channel_constants<Spec, NextPlace>>>{};
            else
                return not_fused{};
        } else if constexpr (!Activation->exists &&
                             activates<Spec, typename Place::format, layer::output.channels>) {
            return std::type_identity<
                lowered_transposed_convolution<Place, Norm, lowering<Spec>::activation>>{};
        } else {
            return not_fused{};
        }
    }
};

template <std::size_t Filters, extent2d Kernel, extent2d Stride, padding Padding, bool Bias>
struct lowering<transposed_conv2d<Filters, Kernel, Stride, Padding, Bias>> {
    template <class Place>
    using at = lowered_transposed_convolution<Place>;
};

}} // namespace tactnet
