#pragma once

#include <tactnet/operators/sample_norms/layer.hpp>

#include <cstddef>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t Groups, std::size_t Channels>
concept groups_divide_channels = (Groups > 0) && (Channels % Groups == 0);

namespace detail {

template <std::size_t Groups, std::size_t Channels, std::size_t Area>
[[nodiscard]] constexpr kernels::norm_groups channel_groups() {
    static_assert(groups_divide_channels<Groups, Channels>,
                  "group_norm: groups must divide the channels of the input; groups_divide_channels shows "
                  "groups and channels");
    if constexpr (groups_divide_channels<Groups, Channels>)
        return groups_with_variance<Channels / Groups * Area>(
            kernels::norm_groups::of_channels(Groups, Channels / Groups, Area));
    else
        return kernels::norm_groups::of_channels(1, Channels, Area);
}

} // namespace detail

/// Group normalisation (Wu and He, "Group normalization", 2018): brings each of `Groups` groups of successive
/// channels of each sample to mean 0 and variance 1 over all pixels, then each channel to a learned scale and
/// shift. PyTorch's GroupNorm(groups, C). It computes the same in training and in inference, with any batch.
/// The network sets epsilon (execution_context::epsilon, 1e-5 as in PyTorch).
template <std::size_t Groups>
struct group_norm {
    static constexpr std::string_view name = "gn";
    static constexpr bool numbered = true, weight_per_element = false;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .parameters = 2 * input.channels};
    }
    template <class T, shape Input>
    using layer = detail::sample_norm_layer<group_norm, T, Input,
                                            detail::channel_groups<Groups, Input.channels, Input.area()>()>;
};

/// Instance normalisation (Ulyanov, Vedaldi, Lempitsky, "Instance normalization", 2016): a group norm with
/// one channel in each group. PyTorch's InstanceNorm2d(C, affine=True), which keeps no running statistics.
struct instance_norm {
    static constexpr std::string_view name = "in";
    static constexpr bool numbered = true, weight_per_element = false;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .parameters = 2 * input.channels};
    }
    template <class T, shape Input>
    using layer =
        detail::sample_norm_layer<instance_norm, T, Input,
                                  detail::channel_groups<Input.channels, Input.channels, Input.area()>()>;
};

}} // namespace tactnet
