#pragma once

#include <tactnet/operators/layer.hpp>

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

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
