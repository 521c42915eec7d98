#pragma once

#include <tactnet/operators/layer.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Root mean square normalisation (Zhang and Sennrich, "Root mean square layer normalization", 2019): divides
/// the channels of each pixel by their root mean square, and multiplies each channel by a learned weight,
/// y(c) = x(c) ÷ √(mean of x(i)² + ε) · γ(c). No mean is subtracted and no bias added. PyTorch's RMSNorm(C)
/// of maps with the channels last, ONNX's RMSNormalization. The network sets epsilon
/// (execution_context::epsilon, 1e-5); PyTorch's default is 2⁻²³.
struct rms_norm {
    static constexpr std::string_view name = "rms";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .parameters = input.channels};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, rms_norm> {
        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "weight", parameter_role::scale, {Input.channels}, 0);
        }
    };
};

}} // namespace tactnet
