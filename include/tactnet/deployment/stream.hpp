#pragma once

#include <tactnet/deployment/lowering/streams.hpp>
#include <tactnet/deployment/stream_view.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

// A trained network of sequences, run frame by frame in a control loop.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The layers before a softmax at the end, without names.
template <class Specification>
struct stream_logits;
template <class... Specs>
struct stream_logits<sequence<Specs...>> {
    using type = typename split_softmax<sequence<>, tactnet::without_name<Specs>...>::logits;
};

/// The steps of a network of sequences.
template <class Network, class Format>
struct stream_steps {
    static constexpr shape input = Network::input_shape; ///< of a whole sequence
    static_assert(
        one_column<input.columns>,
        "deploy_stream: the input must be a sequence {frames, 1, features}; one_column shows its columns");
    using type = typename stream_lowering<typename stream_logits<typename Network::specification>::type,
                                          input, Format>::step;
};

/// The folded numbers and the packed weights of a stream, and its calls.
template <class Steps>
class stream_weights : public stream_calls<stream_weights<Steps>, Steps::features, Steps::outputs> {
    using calls = stream_calls<stream_weights, Steps::features, Steps::outputs>;

public:
    /// The calls without files, exceptions and heap.
    using view_type = stream_view<Steps>;
    using calls::features;
    using calls::outputs;
    static constexpr std::size_t weight_bytes = view_type::weight_bytes;
    static constexpr std::size_t folded_elements = view_type::folded_elements; ///< of `folded`

    /// What the network remembers from frame to frame, as a plain struct. `state{}` is the beginning of a
    /// recording; a copy is a point to return to, and save_state writes it (stream_state.hpp).
    using state = typename view_type::state;
    static constexpr std::size_t state_bytes = view_type::state_bytes;

    /// The numbers before packing, which are the same on every machine.
    [[nodiscard]] std::span<const float, folded_elements> folded() const noexcept {
        return std::span<const float, folded_elements>(folded_.data(), folded_elements);
    }
    /// A view of these weights, which must outlive the view.
    [[nodiscard]] view_type view() const& noexcept { return view_type(packed_.data()); }
    view_type view() const&& = delete;
    /// Every output stands for a class.
    [[nodiscard]] static constexpr std::size_t class_count() noexcept { return outputs; }

    /// Takes the features of one frame, writes the outputs after it and updates the state. For a frame that
    /// the stream refuses, returns not_finite; the state and the outputs are then unchanged, as if there had
    /// been no such frame.
    frame_status step(std::span<const float, features> frame, state& memory,
                      std::span<float, outputs> to) const noexcept {
        return view().step(frame, memory, to);
    }

protected:
    explicit stream_weights(std::vector<float> folded)
        : folded_(std::move(folded)), packed_(view_type::packed_elements) {
        view_type::pack(folded_.data(), packed_.data());
    }

private:
    std::vector<float> folded_;
    aligned_vector<typename Steps::format::packed_number> packed_;
};

} // namespace detail

/// A network of sequences with packed weights, for frames as they come. `step` takes one frame and updates a
/// state, which belongs to the caller; the stream itself is constant, so any number of threads and recordings
/// share it, each with a state of its own. Calls use no heap, no exceptions and no branch on the instruction
/// set. Outputs after each frame are bit-identical with those of the network in single precision
/// (`basic_network::logits`) for the sequence up to this frame, in batches of any size.
///
/// It refuses a frame with a feature that is NaN, infinite, or so large that sums might leave the range of
/// single precision.
///
/// `Network` has an input {frames, 1, features} and runs through time by causal layers only: gru, lstm,
/// causal_conv1d, activations, dropout, residual blocks and lists of these; then, after last_frame, dense
/// layers. The outputs are logits, also if the network ends in a softmax.
///
/// deployment/eight_bit/stream.hpp specialises it for the format `eight_bit`.
template <class Network, class Format = single_precision>
class deployed_stream : public detail::stream_weights<typename detail::stream_steps<Network, Format>::type> {
    static_assert(std::is_same_v<Format, single_precision>,
                  "deploy_stream: include tactnet/quantisation.hpp for streams in 8 bits");
    using steps = typename detail::stream_steps<Network, Format>::type;

public:
    /// Packs the weights of a network. Throws std::invalid_argument if they are not finite, or so large that
    /// sums may leave the range of single precision for inputs of zero, and std::bad_alloc.
    explicit deployed_stream(const Network& network) : detail::stream_weights<steps>(fold(network)) {}

private:
    /// The largest feature, then the parameters.
    [[nodiscard]] static std::vector<float> fold(const Network& network) {
        static_assert(std::is_same_v<typename Network::value_type, float>,
                      "deploy_stream: the network must be in single precision");
        const std::span<const float> values = network.learnable_values().first(Network::parameters);
        std::vector<float> folded(1 + steps::folded_elements);
        steps::fold(values.data(), folded.data() + 1);
        // Sums of so many terms may exceed the bound by their rounding, which half the range leaves room for.
        constexpr double most = std::numeric_limits<float>::max() / 2;
        const auto fits = [&](double of_input) {
            return steps::output_bound(folded.data() + 1, of_input) <= most;
        };
        double limit = most;
        while (limit >= std::numeric_limits<float>::min() && !fits(limit))
            limit /= 2;
        const bool finite =
            std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
        if (!finite || !fits(limit))
            throw std::invalid_argument("deploy_stream: expected parameters that give finite numbers, found "
                                        "some that are not finite or too large");
        folded[0] = static_cast<float>(limit);
        return folded;
    }
};

/// Packs a trained network of sequences for frames as they come. Throws as the constructor of
/// deployed_stream.
template <class Network>
[[nodiscard]] deployed_stream<Network> deploy_stream(const Network& network) {
    return deployed_stream<Network>(network);
}

}} // namespace tactnet
