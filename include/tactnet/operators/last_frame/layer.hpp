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
    struct layer : lane_block_layer<T, Input, last_frame> {
        static constexpr shape output = detail::sequence_output<Input.columns, 1>({1, 1, Input.channels});

        static void forward_block(const T* in, T* out) { detail::read_frame<Input>(in, Input.rows - 1, out); }
        static void backward_block(const T*, const T*, const T* out_gradient, T* in_gradient) {
            std::fill_n(in_gradient, Input.size() * kernels::lanes<T>, T{});
            detail::write_frame<Input>(out_gradient, Input.rows - 1, in_gradient);
        }
    };
};

}} // namespace tactnet
