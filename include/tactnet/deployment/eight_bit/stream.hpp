#pragma once

#include <tactnet/deployment/eight_bit.hpp>
#include <tactnet/deployment/eight_bit/streaming/lowering.hpp>
#include <tactnet/deployment/stream.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

// A network of sequences in 8 bits, run frame by frame. To make one of a trained network, include
// tactnet/quantisation.hpp.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Appends the names of a step's folded numbers.
template <class Step>
struct stream_arrays {
    [[gnu::cold]] static void append(folded_layout& to, const std::string& name) {
        Step::visit_arrays([&](const char* part, const folded_arrays& arrays, double largest_input) {
            append_step(to, part_name(name, part), arrays, largest_input);
        });
    }
};
template <class... Steps>
struct stream_arrays<stream_chain<Steps...>> {
    [[gnu::cold]] static void append(folded_layout& to, const std::string& name) {
        std::size_t place = 0;
        (stream_arrays<Steps>::append(to, part_name(name, "step", ++place)), ...);
    }
};
template <class Format, class Main, class Skip>
struct stream_arrays<residual_stream_step<Format, Main, Skip>> {
    [[gnu::cold]] static void append(folded_layout& to, const std::string& name) {
        stream_arrays<Main>::append(to, name + ".main");
        stream_arrays<Skip>::append(to, name + ".skip");
        append_step(to, name, residual_stream_step<Format, Main, Skip>::arrays, 0);
        to.steps.back().adds = true;
    }
};

} // namespace detail

/// The parts of a stream in 8 bits: the words of a frame, the steps of the layers, and the outputs. Folded
/// numbers come in this order.
template <class Network>
struct eight_bit_stream_plan {
    static constexpr shape input = Network::input_shape; ///< of a whole sequence
    /// Those of the layers, from words to floats or bytes.
    using steps = typename detail::stream_steps<Network, eight_bit_between<std::int16_t, float>>::type;
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
        detail::stream_arrays<steps>::append(all, "");
        if constexpr (!writes_floats)
            detail::append_step(all, "outputs", range, 0);
        return all;
    }
};

/// A network of sequences in 8 bits: deployed_stream of its network, with the same calls and the same
/// guarantees. Features are rounded to words of 16 bits, each with a step of its own, and finite ones beyond
/// these saturate: it refuses a frame with a feature that is NaN or infinite. Weights are signed bytes, as in
/// other networks of 8 bits, hidden states 16 bits (kernels/integer/recurrent.hpp). Outputs are bit-identical
/// on every instruction set.
///
/// The first layer is gru, lstm, causal_conv1d or dense.
template <class Network>
class deployed_stream<Network, eight_bit>
    : public detail::stream_weights<typename eight_bit_stream_plan<Network>::steps> {
    using plan = eight_bit_stream_plan<Network>;
    using weights = detail::stream_weights<typename plan::steps>;

public:
    using weights::folded_elements;

    /// From folded numbers, as `folded` and `stream_calibration` return them. Throws std::invalid_argument if
    /// one is not finite, or if 8 bits cannot hold it, and std::bad_alloc.
    explicit deployed_stream(std::span<const float, folded_elements> folded) : weights(checked(folded)) {}

private:
    [[nodiscard]] static std::vector<float> checked(std::span<const float, folded_elements> folded) {
        static_assert(folded_elements == plan::folded_elements);
        detail::require_no_problem("deploy_stream", plan::layout(), folded);
        return std::vector<float>(folded.begin(), folded.end());
    }
};

}} // namespace tactnet
