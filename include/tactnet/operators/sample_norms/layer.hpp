#pragma once

#include <tactnet/kernels/norms.hpp>
#include <tactnet/operators/layer.hpp>

#include <cstddef>
#include <ratio>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t Values>
concept has_variance = (Values > 1);

namespace detail {

/// Rejects groups of a single value, of which a norm leaves nothing but the bias.
template <std::size_t Values>
[[nodiscard]] constexpr kernels::norm_groups groups_with_variance(const kernels::norm_groups& groups) {
    static_assert(has_variance<Values>,
                  "group_norm, instance_norm, layer_norm: a single value has no variance: there must be two "
                  "or more to normalise together");
    return groups;
}

/// The layer of a norm with moments for each sample, the same in training and in inference. Weights are per
/// channel, or per element [channel][row][column].
template <class Spec, class T, shape Input, kernels::norm_groups Groups>
struct sample_norm_layer : layer_base<T, Input, Spec> {
    static constexpr kernels::norm_groups groups = Groups;
    static constexpr std::size_t weights = layer_base<T, Input, Spec>::parameters / 2;

    static void describe(const std::string& prefix, std::vector<parameter>& list) {
        const auto add = [&](const char* name, parameter_role role, std::size_t offset) {
            if constexpr (Spec::weight_per_element)
                describe_array(list, prefix, name, role, {Input.channels, Input.rows, Input.columns}, offset);
            else
                describe_array(list, prefix, name, role, {Input.channels}, offset);
        };
        add("weight", parameter_role::scale, 0);
        add("bias", parameter_role::shift, weights);
    }
};

} // namespace detail

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

namespace detail {

template <std::size_t Size, class Alpha, class Beta, class K>
[[nodiscard]] constexpr shape local_response_output(shape output) {
    static_assert(Size > 0, "local_response_norm: the window must hold at least one channel");
    static_assert(std::ratio_greater_v<K, std::ratio<0>>, "local_response_norm: k must be above zero");
    static_assert(Alpha::num >= 0 && Beta::num >= 0,
                  "local_response_norm: alpha and beta must not be below zero");
    return output;
}

} // namespace detail

/// Local response normalisation across channels (Krizhevsky, Sutskever, Hinton, 2012, section 3.3):
/// y(c) = x(c) · (k + α ÷ size · Σ x(i)²)^−β over the `size` channels around c. As in Caffe, MATLAB and
/// PyTorch, α is divided by the size: the paper's α = 1e-4 at size 5, k = 2, is their 5e-4. If the size is
/// even, one more channel lies before c than after it, as in PyTorch. The constants are fractions
/// (std::ratio).
template <std::size_t Size = 5, class Alpha = std::ratio<1, 10000>, class Beta = std::ratio<3, 4>,
          class K = std::ratio<1>>
struct local_response_norm {
    static constexpr std::string_view name = "lrn";
    static constexpr bool numbered = true;
    using rule = kernels::response_rule<Size, Alpha, Beta, K>;

    static constexpr layer_costs costs(const shape& input) { return {.output = input}; }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, local_response_norm> {
        static constexpr shape output = detail::local_response_output<Size, Alpha, Beta, K>(Input);
    };
};

}} // namespace tactnet
