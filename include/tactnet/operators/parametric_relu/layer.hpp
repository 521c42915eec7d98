#pragma once

#include <tactnet/operators/layer.hpp>

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Parametric ReLU (He, Zhang, Ren, Sun, "Delving deep into rectifiers", 2015): x above 0, otherwise slope ·
/// x, with a learned slope for each channel. PyTorch's nn.PReLU(channels); in weight files "prelu1.weight" of
/// shape [channels]. `initialise` sets slopes to ¼, and weight decay leaves them alone.
struct parametric_relu {
    static constexpr std::string_view name = "prelu";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .parameters = input.channels};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, parametric_relu> {
        static constexpr std::size_t channels = Input.channels;

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "weight", parameter_role::slope, {channels}, 0);
        }
    };
};

}} // namespace tactnet
