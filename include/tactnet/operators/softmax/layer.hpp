#pragma once

#include <tactnet/operators/layer.hpp>

#include <array>
#include <cstddef>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Softmax over the channels of each pixel, for lists that end in probabilities. The networks of the paper
/// end in logits. Training joins softmax and cross-entropy (training/loss.hpp), which is exact where
/// probabilities are not, so a network has logits whether its list ends in softmax or not.
struct softmax {
    static constexpr std::string_view name = "softmax";
    static constexpr bool numbered = false;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    template <class T, shape Input>
    using layer = layer_base<T, Input, softmax>;
};

}} // namespace tactnet
