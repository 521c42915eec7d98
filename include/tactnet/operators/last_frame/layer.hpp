#pragma once

#include <tactnet/operators/frames.hpp>

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The features of the last frame of a sequence, without the others: what a classifier of whole sequences
/// reads after a recurrent or a causal layer. In a stream the last frame is the present one.
struct last_frame {
    static constexpr std::string_view name = "last";
    static constexpr bool numbered = true, takes_sequences = true;

    static constexpr layer_costs costs(const shape& input) { return {.output = {1, 1, input.channels}}; }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, last_frame> {
        static constexpr shape output = detail::sequence_output<Input.columns, 1>({1, 1, Input.channels});
    };
};

}} // namespace tactnet
