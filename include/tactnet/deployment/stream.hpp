#pragma once

#include <tactnet/deployment/frame_ref.hpp>
#include <tactnet/deployment/streaming/stream_calls.hpp>
#include <tactnet/deployment/streaming/stream_list.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <type_traits>

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

} // namespace detail

/// A network of sequences with packed weights, for frames as they come. `step` takes one frame and updates a
/// state, which belongs to the caller; the stream itself is constant, so any number of threads and recordings
/// share it, each with a state of its own. Calls use no heap, no exceptions and no branch on the instruction
/// set. Outputs after each frame are bit-identical with those of the network in single precision
/// (`basic_network::logits`) for the sequence up to this frame, in batches of any size.
///
/// `Network` has an input {frames, 1, features} and runs through time by causal layers only: gru, lstm,
/// causal_conv1d, activations, dropout, residual blocks and lists of these; then, after last_frame, dense
/// layers. The outputs are logits, also if the network ends in a softmax.
///
/// deployment/eight_bit/stream.hpp specialises it for the format `eight_bit`.
template <class Network, class Format = single_precision>
class deployed_stream
    : public detail::stream_calls<deployed_stream<Network, Format>, Network::input_shape.channels,
                                  Network::output_shape.channels> {
    static_assert(std::is_same_v<Format, single_precision>,
                  "deploy_stream: include tactnet/quantisation.hpp for streams in 8 bits");
    using calls =
        detail::stream_calls<deployed_stream, Network::input_shape.channels, Network::output_shape.channels>;
    static constexpr shape input = Network::input_shape;
    static_assert(
        one_column<input.columns>,
        "deploy_stream: the input must be a sequence {frames, 1, features}; one_column shows its columns");
    using steps = stream_step<typename detail::stream_logits<typename Network::specification>::type, input>;
    static constexpr std::size_t padded_outputs = kernels::padded_size<float>(Network::output_shape.channels);

public:
    using calls::features;
    using calls::outputs;
    static constexpr std::size_t weight_bytes = steps::packed_elements * sizeof(float);

    /// What the network remembers from frame to frame, as a plain struct. `state{}` is the beginning of a
    /// recording; a copy is a point to return to.
    using state = typename steps::state;
    static constexpr std::size_t state_bytes = sizeof(state);

    /// Packs the weights of a network. Throws std::invalid_argument if they are not finite, or so large that
    /// sums may leave the range of single precision for inputs of zero, and std::bad_alloc.
    explicit deployed_stream(const Network& network) : packed_(steps::packed_elements) {
        static_assert(std::is_same_v<typename Network::value_type, float>,
                      "deploy_stream: the network must be in single precision");
        const std::span<const float> values = network.learnable_values().first(Network::parameters);
        steps::pack(values.data(), packed_.data());
        // Sums of so many terms may exceed the bound by their rounding, which half the range leaves room for.
        constexpr double most = std::numeric_limits<float>::max() / 2;
        const auto fits = [&](double of_input) {
            return steps::output_bound(values.data(), of_input) <= most;
        };
        double limit = most;
        while (limit >= std::numeric_limits<float>::min() && !fits(limit))
            limit /= 2;
        const bool finite =
            std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
        if (!finite || !fits(limit))
            throw std::invalid_argument("deploy_stream: expected parameters that give finite numbers, found "
                                        "some that are not finite or too large");
        limit_ = static_cast<float>(limit);
    }

    /// Takes the features of one frame, writes the outputs after it and updates the state. For a feature that
    /// is NaN, infinite, or so large that sums might leave the range of single precision, returns not_finite;
    /// the state and the outputs are then unchanged, as if there had been no such frame.
    frame_status step(std::span<const float, features> frame, state& memory,
                      std::span<float, outputs> to) const noexcept {
        alignas(vector_alignment) std::array<float, kernels::padded_size<float>(features)> in{};
        std::size_t out_of_range = 0;
        for (std::size_t f = 0; f < features; ++f) {
            in[f] = frame[f];
            out_of_range += !(std::abs(frame[f]) <= limit_);
        }
        if (out_of_range > 0)
            return frame_status::not_finite;
        alignas(vector_alignment) std::array<float, padded_outputs> out;
        steps::run(packed_.data(), in.data(), memory, out.data());
        std::copy_n(out.data(), outputs, to.data());
        return frame_status::ok;
    }

private:
    aligned_vector<float> packed_;
    float limit_ = 0;
};

/// Packs a trained network of sequences for frames as they come. Throws as the constructor of
/// deployed_stream.
template <class Network>
[[nodiscard]] deployed_stream<Network> deploy_stream(const Network& network) {
    return deployed_stream<Network>(network);
}

}} // namespace tactnet
