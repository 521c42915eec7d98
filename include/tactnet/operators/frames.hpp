#pragma once

#include <tactnet/operators/layer.hpp>

#include <cstddef>

// Sequences of frames, for layers that run through time. A sequence has the shape {frames, 1, features}: a
// row for each frame, in the order of recording, and a channel for each feature. A sample lies feature by
// feature, as the input of PyTorch's Conv1d. `deploy_stream` runs such a network frame by frame
// (deployment/stream.hpp), so the number of frames matters for training alone.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Whether a shape can be that of a sequence.
template <std::size_t Columns>
concept one_column = Columns == 1;

/// A layer that needs a sequence, and that `deploy_stream` can run frame by frame.
template <class Spec>
concept layer_of_sequences = requires { requires Spec::takes_sequences; };

namespace detail {

/// Rejects inputs that are no sequence, and layers without outputs.
template <std::size_t Columns, std::size_t Outputs>
[[nodiscard]] constexpr shape sequence_output(shape output) {
    static_assert(
        one_column<Columns>,
        "sequence: the input must be a sequence {frames, 1, features}; one_column shows its columns");
    static_assert(Outputs > 0,
                  "sequence: a layer must have at least one output, one tap and a dilation of one");
    return output;
}

} // namespace detail
}} // namespace tactnet
