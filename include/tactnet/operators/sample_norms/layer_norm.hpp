#pragma once

#include <tactnet/operators/sample_norms/layer.hpp>

#include <cstddef>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

/// What a layer norm normalises together: all channels and pixels of a frame, or the channels of each pixel.
enum class norm_over { frame, channels };

namespace detail {

/// A frame with a weight for each element is one group of channels of a pixel each.
template <norm_over Over, std::size_t Channels, std::size_t Area>
[[nodiscard]] constexpr kernels::norm_groups layer_norm_groups() {
    if constexpr (Over == norm_over::frame)
        return groups_with_variance<Channels * Area>(
            kernels::norm_groups::of_channels(1, Channels * Area, 1));
    else
        return groups_with_variance<Channels>(kernels::norm_groups::of_pixels(Channels, Area));
}

} // namespace detail

/// Layer normalisation (Ba, Kiros, Hinton, "Layer normalization", 2016): brings the elements of each sample
/// to mean 0 and variance 1, then to a learned scale and shift.
///  - `norm_over::frame`: all elements together, with a scale and a shift for each element [channel][row]
///    [column]: PyTorch's LayerNorm((C, H, W)).
///  - `norm_over::channels`: the channels of each pixel, with a scale and a shift for each channel. This
///    is the norm of ConvNeXt (Liu et al., 2022), PyTorch's LayerNorm(C) of maps with the channels last.
/// The network sets epsilon (execution_context::epsilon): PyTorch's default is 1e-5, ConvNeXt has 1e-6.
template <norm_over Over>
struct layer_norm {
    static constexpr std::string_view name = "ln";
    static constexpr bool numbered = true, weight_per_element = Over == norm_over::frame;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .parameters = 2 * (weight_per_element ? input.size() : input.channels)};
    }
    template <class T, shape Input>
    using layer = detail::sample_norm_layer<layer_norm, T, Input,
                                            detail::layer_norm_groups<Over, Input.channels, Input.area()>()>;
};

}} // namespace tactnet
