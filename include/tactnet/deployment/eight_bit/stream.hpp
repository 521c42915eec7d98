#pragma once

#include <tactnet/deployment/eight_bit.hpp>
#include <tactnet/deployment/eight_bit/streaming/stream_list.hpp>
#include <tactnet/deployment/stream.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

// A network of sequences in 8 bits, run frame by frame. To make one of a trained network, include
// tactnet/quantisation.hpp.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The parts of a stream in 8 bits: the words of a frame, the steps of the layers, and the outputs. Folded
/// numbers come in this order.
template <class Network>
struct eight_bit_stream_plan {
    static constexpr shape input = Network::input_shape; ///< of a whole sequence
    static_assert(
        one_column<input.columns>,
        "deploy_stream: the input must be a sequence {frames, 1, features}; one_column shows its columns");
    /// Those of the layers, from words to floats or bytes.
    using steps = stream_step<typename detail::stream_logits<typename Network::specification>::type, input,
                              eight_bit_between<std::int16_t, float>>;
    static_assert(!std::is_same_v<typename steps::output_number, std::int16_t>,
                  "deploy_stream: in 8 bits, the network needs a layer with weights");
    /// Otherwise the last layer writes bytes.
    static constexpr bool writes_floats = std::is_same_v<typename steps::output_number, float>;
    /// The value of one step of a feature's words, of which the first layer reads whole numbers.
    static constexpr folded_arrays word_steps{{"step", folded_kind::scales, {input.channels}}};
    /// The range of bytes that are outputs.
    static constexpr folded_arrays range{{"range", folded_kind::range, {map_range::numbers}}};
    /// How many folded numbers there are.
    static constexpr std::size_t folded_elements =
        word_steps.numbers() + steps::folded_elements + (writes_floats ? 0 : map_range::numbers);
    static constexpr std::size_t output_range = folded_elements - map_range::numbers; ///< of bytes

    /// The names of the folded numbers.
    [[nodiscard]] [[gnu::cold]] static folded_layout layout() {
        folded_layout all{{1, 1, input.channels}, Network::output_shape.channels, 0, 0, false, {}};
        detail::append_step(all, "frame", word_steps, 0);
        steps::append_arrays(all, "");
        if constexpr (!writes_floats)
            detail::append_step(all, "outputs", range, 0);
        return all;
    }
};

/// A network of sequences in 8 bits: deployed_stream of its network, with the same calls and the same
/// guarantees. Features are rounded to words of 16 bits, each with a step of its own, and finite ones beyond
/// these saturate. Weights are signed bytes, as in other networks of 8 bits, hidden states 16 bits
/// (kernels/integer/recurrent.hpp). Outputs are bit-identical on every instruction set.
///
/// The first layer is gru, lstm, causal_conv1d or dense.
template <class Network>
class deployed_stream<Network, eight_bit>
    : public detail::stream_calls<deployed_stream<Network, eight_bit>, Network::input_shape.channels,
                                  Network::output_shape.channels> {
    using calls =
        detail::stream_calls<deployed_stream, Network::input_shape.channels, Network::output_shape.channels>;
    using plan = eight_bit_stream_plan<Network>;
    using steps = typename plan::steps;

public:
    using calls::features;
    using calls::outputs;
    static constexpr std::size_t weight_bytes = steps::packed_elements;
    static constexpr std::size_t folded_elements = plan::folded_elements; ///< of `folded`
    /// What the network remembers from frame to frame, as a plain struct. `state{}` is the beginning of a
    /// recording; a copy is a point to return to.
    using state = typename steps::state;
    static constexpr std::size_t state_bytes = sizeof(state);

    /// From folded numbers, as `folded` and `stream_calibration` return them. Throws std::invalid_argument if
    /// one is not finite, or if 8 bits cannot hold it, and std::bad_alloc.
    explicit deployed_stream(std::span<const float, folded_elements> folded)
        : folded_(folded.begin(), folded.end()), packed_(steps::packed_elements) {
        detail::require_no_problem("deploy_stream", plan::layout(), folded);
        for (std::size_t f = 0; f < features; ++f)
            steps_per_unit_[f] = 1 / folded[f];
        steps::pack(folded_.data() + features, packed_.data());
    }
    /// The numbers before packing, which make the same stream again.
    [[nodiscard]] std::span<const float, folded_elements> folded() const noexcept {
        return std::span<const float, folded_elements>(folded_.data(), folded_elements);
    }

    /// Takes the features of one frame, writes the outputs after it and updates the state. For a feature that
    /// is NaN or infinite, returns not_finite; the state and the outputs are then unchanged, as if there had
    /// been no such frame.
    frame_status step(std::span<const float, features> frame, state& memory,
                      std::span<float, outputs> to) const noexcept {
        alignas(vector_alignment) std::array<std::int16_t, pad_to_cache_line<std::int16_t>(features)> words{};
        std::size_t broken = 0;
        for (std::size_t f = 0; f < features; ++f) {
            constexpr float limit = std::numeric_limits<std::int16_t>::max();
            broken += !(std::abs(frame[f]) <= std::numeric_limits<float>::max());
            // The clamp lies between the product and the sum that rounds it.
            const float scaled = std::clamp(frame[f] * steps_per_unit_[f], -limit, limit);
            words[f] = static_cast<std::int16_t>(kernels::nearest<1>(kernels::float_vec<1>{scaled})[0]);
        }
        if (broken > 0)
            return frame_status::not_finite;
        alignas(vector_alignment) std::array<float, pad_to_cache_line(outputs)> out{};
        alignas(vector_alignment)
            std::array<std::uint8_t, pad_to_cache_line<std::uint8_t>(steps::workspace_elements + 1)>
                workspace;
        auto* const bytes = reinterpret_cast<std::uint8_t*>(out.data());
        steps::run(packed_.data(), reinterpret_cast<const std::uint8_t*>(words.data()), memory, bytes,
                   workspace.data());
        if constexpr (plan::writes_floats) {
            std::copy_n(out.data(), outputs, to.data());
        } else {
            const map_range range = map_range::read(folded_.data() + plan::output_range);
            for (std::size_t o = 0; o < outputs; ++o)
                to[o] = (static_cast<float>(bytes[o]) - range.zero_point) * range.scale;
        }
        return frame_status::ok;
    }

private:
    std::vector<float> folded_;
    aligned_vector<std::int8_t> packed_;
    std::array<float, features> steps_per_unit_;
};

}} // namespace tactnet
