#pragma once

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

}} // namespace tactnet
