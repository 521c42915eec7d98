#pragma once

#include <tactnet/operators/layer.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Batch normalisation (Ioffe and Szegedy, 2015): brings each channel to mean 0 and variance 1, then to a
/// learned scale and shift. Training uses the moments of the batch, inference the running ones. The network
/// sets epsilon (execution_context::epsilon): the paper's text says 1e-4, its published networks 1e-5.
struct batch_norm {
    static constexpr std::string_view name = "bn";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .parameters = 2 * input.channels, .statistics = 2 * input.channels};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, batch_norm> {
        static constexpr std::size_t channels = Input.channels;

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "weight", parameter_role::scale, {channels}, 0);
            describe_array(list, prefix, "bias", parameter_role::shift, {channels}, channels);
            describe_array(list, prefix, "running_mean", parameter_role::running_mean, {channels}, 0);
            describe_array(list, prefix, "running_var", parameter_role::running_variance, {channels},
                           channels);
        }
    };
};

/// Layer scale (Touvron et al., "Going deeper with image transformers", 2021, equation 4): each channel times
/// a learned number, y(c) = γ(c) · x(c), at the end of a branch of a residual block, as in ConvNeXt. Networks
/// begin with γ = 1; ConvNeXt begins with 1e-6. Deployed, it becomes part of the convolution before it.
struct channel_scale {
    static constexpr std::string_view name = "scale";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .parameters = input.channels};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, channel_scale> {
        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "gamma", parameter_role::scale, {Input.channels}, 0);
        }
    };
};

}} // namespace tactnet
