#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/stream_view.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators/layer.hpp>
#include <tactnet/operators/lowering.hpp>
#include <tactnet/operators/sequence/lowering.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

// A trained network of sequences, run frame by frame in a control loop.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The steps of a network of sequences for one frame, and how its parameters fold into them.
template <class Network, class Format = single_precision>
struct lowered_stream {
    static constexpr shape input = Network::input_shape; ///< of a whole sequence
    static_assert(
        one_column<input.columns>,
        "deploy_stream: the input must be a sequence {frames, 1, features}; one_column shows its columns");
    using type =
        typename lowered_sequence<typename Format::input_format, typename Network::logit_specification,
                                  typename Network::layers, input.channels,
                                  input.rows>::template ending<Format::has_output_format>;
};
template <class Network, class Format>
    requires inference_no_op<typename Network::logit_specification>
struct lowered_stream<Network, Format> {
    static constexpr bool check() {
        static_assert(Network::outputs == 0, "deploy_stream: the network needs a layer with weights");
        return true;
    }
    static_assert(check());
    using type = lowered_chain< // or more errors follow
        lowered_to<
            float_output_step<typename Format::hidden_format, shape{1, 1, Network::input_shape.channels},
                              Network::input_shape.channels>>>;
};

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
/// With the format `eight_bit`, for which you include tactnet/quantisation.hpp or, to run streams only,
/// tactnet/deployment/eight_bit.hpp, the calls and the guarantees are the same, with these differences.
/// Features are rounded to words of 16 bits, each with a step of its own, and finite ones beyond these
/// saturate: a stream refuses NaN and infinity alone. Weights are signed bytes, as in other networks of 8
/// bits, hidden states 16 bits (kernels/integer/recurrent.hpp). Outputs are bit-identical on every
/// instruction set, not with the network. The first layer is gru, lstm, causal_conv1d or dense.
template <class Network, class Format = single_precision>
class deployed_stream {
    using lowered = typename lowered_stream<Network, Format>::type;

public:
    /// The calls without files, exceptions and heap.
    using view_type = stream_view<Network::input_shape.channels, typename lowered::step>;
    static constexpr std::size_t features = view_type::features; ///< numbers of a frame
    static constexpr std::size_t outputs = view_type::outputs;   ///< numbers after each frame
    static constexpr std::size_t weight_bytes = view_type::weight_bytes;
    static constexpr std::size_t folded_elements = view_type::folded_elements; ///< of `folded`

    /// What the network remembers from frame to frame, as a plain struct. `state{}` is the beginning of a
    /// recording; a copy is a point to return to, and save_state writes it.
    using state = typename view_type::state;
    static constexpr std::size_t state_bytes = view_type::state_bytes;
    static_assert(std::is_same_v<typename Network::value_type, float>,
                  "deploy_stream: the network must be in single precision");

    /// Packs the weights of a network. Throws std::invalid_argument if they are not finite, or so large that
    /// sums may leave the range of single precision for inputs of zero, and std::bad_alloc.
    explicit deployed_stream(const Network& network)
        requires std::is_same_v<Format, single_precision>
        : deployed_stream(fold(network)) {}
    /// From folded numbers, as `folded` and `stream_calibration` return them. Throws std::invalid_argument if
    /// one is not finite, or if the format cannot hold it, and std::bad_alloc.
    explicit deployed_stream(std::span<const float, folded_elements> folded)
        requires(!std::is_same_v<Format, single_precision>)
        : deployed_stream(checked(folded)) {}

    /// The numbers before packing, which are the same on every machine.
    [[nodiscard]] std::span<const float, folded_elements> folded() const noexcept {
        return std::span<const float, folded_elements>(folded_.data(), folded_elements);
    }
    /// A view of these weights, which must outlive the view.
    [[nodiscard]] view_type view() const& noexcept {
        return view_type(packed_.data(), outputs, temperature_);
    }
    view_type view() const&& = delete;
    /// Sets what logits are divided by for the probabilities of `classify`, as fit_temperature finds it.
    /// Throws std::invalid_argument unless is_temperature(temperature).
    void set_temperature(double temperature) {
        detail::check_temperature("deploy_stream", temperature);
        temperature_ = temperature;
    }
    /// 1, or the temperature of the model.
    [[nodiscard]] double temperature() const noexcept { return temperature_; }
    /// Every output stands for a class.
    [[nodiscard]] static constexpr std::size_t class_count() noexcept { return outputs; }

    /// Takes the features of one frame, writes the outputs after it and updates the state. For a frame that
    /// the stream refuses, returns not_finite; the state and the outputs are then unchanged, as if there had
    /// been no such frame.
    frame_status step(std::span<const float, features> frame, state& memory,
                      std::span<float, outputs> to) const noexcept {
        return view().step(frame, memory, to);
    }
    /// As stream_view::classify.
    [[nodiscard]] std::optional<recognition> classify(std::span<const float, features> frame,
                                                      state& memory) const noexcept {
        return view().classify(frame, memory);
    }
    /// As stream_view::run.
    [[nodiscard]] std::size_t run(std::span<const float> recording, state& memory,
                                  std::span<float> to) const noexcept {
        return view().run(recording, memory, to);
    }
    /// As stream_view::restore_state.
    [[nodiscard]] restore_status restore_state(std::span<const std::byte> from,
                                               state& memory) const noexcept {
        return view().restore_state(from, memory);
    }

private:
    explicit deployed_stream(std::vector<float> folded)
        : folded_(std::move(folded)), packed_(view_type::packed_elements) {
        view_type::pack(folded_.data(), packed_.data());
    }
    [[nodiscard]] static std::vector<float> checked(std::span<const float, folded_elements> folded) {
        detail::folded_check<Format>::template require<view_type>("deploy_stream", folded);
        return std::vector<float>(folded.begin(), folded.end());
    }
    /// The largest feature and inputs of states, then the parameters.
    [[nodiscard]] static std::vector<float> fold(const Network& network) {
        using steps = typename lowered::step;
        const std::span<const float> values = network.learnable_values().first(Network::parameters);
        std::vector<float> folded(folded_elements);
        float* const parameters = folded.data() + view_type::steps_folded;
        lowered::fold({values.data(), nullptr, 0}, parameters);
        // Sums of so many terms may exceed the bound by their rounding, which half the range leaves room for.
        constexpr double most = std::numeric_limits<float>::max() / 2;
        const auto fits = [&](double of_input) { return steps::output_bound(parameters, of_input) <= most; };
        double limit = most;
        while (limit >= std::numeric_limits<float>::min() && !fits(limit))
            limit /= 2;
        const bool finite =
            std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
        if (!finite || !fits(limit))
            throw std::invalid_argument("deploy_stream: expected parameters that give finite numbers, found "
                                        "some that are not finite or too large");
        float* next = folded.data();
        *next++ = static_cast<float>(limit);
        detail::visit_inputs<steps>(parameters, limit, [&](double bound) {
            *next++ = static_cast<float>(1.25 * bound); // which roundings may exceed a little
        });
        return folded;
    }

    std::vector<float> folded_;
    detail::weight_vector<typename Format::packed_number> packed_;
    double temperature_ = 1;
};

/// Packs a trained network of sequences for frames as they come. Throws as the constructor of
/// deployed_stream, and for a network whose weights are all zero.
template <class Network>
[[nodiscard]] deployed_stream<Network> deploy_stream(const Network& network) {
    detail::check_trained("deploy_stream", network);
    return deployed_stream<Network>(network);
}
/// That of a model, with its temperature. Its normalisation is for images alone: scale the features.
template <class Network>
[[nodiscard]] deployed_stream<Network> deploy_stream(const model<Network>& trained) {
    deployed_stream<Network> stream = deploy_stream(trained.network);
    stream.set_temperature(trained.temperature);
    return stream;
}

}} // namespace tactnet
