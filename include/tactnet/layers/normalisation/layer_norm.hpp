#pragma once

#include <tactnet/layers/normalisation/sample_norm_layer.hpp>

#include <cstddef>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

/// What a layer norm normalises together: all channels and pixels of a frame, or the channels of each pixel.
enum class norm_over { frame, channels };

/// Layer normalisation (Ba, Kiros, Hinton, "Layer normalization", 2016): brings the elements of each sample
/// to mean 0 and variance 1, then to a learned scale and shift.
///  - `norm_over::frame`: all elements together, with a scale and a shift for each element [channel][row]
///    [column]: PyTorch's LayerNorm((C, H, W)).
///  - `norm_over::channels`: the channels of each pixel, with a scale and a shift for each channel: ConvNeXt's
///    norm (Liu et al., 2022), PyTorch's LayerNorm(C) of maps with the channels last.
/// The network sets epsilon (execution_context::epsilon): PyTorch's default is 1e-5, ConvNeXt has 1e-6.
template <norm_over Over>
struct layer_norm {
    static constexpr std::string_view name = "ln";
    static constexpr bool numbered = true, weight_per_element = Over == norm_over::frame;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .parameters = 2 * (weight_per_element ? input.size() : input.channels)};
    }
    /// With a weight for each element, a frame is one group of channels of a pixel each.
    template <class T, shape Input>
    static constexpr kernels::norm_groups groups =
        detail::groups_with_variance<weight_per_element ? Input.size() : Input.channels>(
            weight_per_element ? kernels::norm_groups::of_channels(1, Input.size(), 1)
                               : kernels::norm_groups::of_pixels(Input.channels, Input.area()));
    template <class T, shape Input>
    using layer = detail::sample_norm_layer<layer_norm, T, Input>;
};

}} // namespace tactnet
