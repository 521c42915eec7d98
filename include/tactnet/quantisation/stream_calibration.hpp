#pragma once

#include <tactnet/quantisation/stream_observer.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Post-training quantisation of a network of sequences: ranges of maps from training sequences, weights
/// rounded to the nearest.
template <class Network>
class stream_calibration {
    using plan = eight_bit_stream_plan<Network>;
    using steps = typename plan::steps;
    static constexpr shape input = Network::input_shape;

public:
    /// Features may be so many times as large as on the training sequences before their words saturate.
    static constexpr float headroom = 4;

    /// `sequences` holds consecutive samples of the network, as for training: feature by feature, each from
    /// the first frame to the last. Throws std::invalid_argument unless there is at least one whole sequence,
    /// and if a number of the network or of a sequence, or what they give, is not finite.
    [[gnu::cold]] stream_calibration(const Network& network, std::span<const float> sequences)
        : folded_(plan::folded_elements) {
        static_assert(std::is_same_v<typename Network::value_type, float>,
                      "deploy_stream: the network must be in single precision");
        if (sequences.empty() || sequences.size() % input.size() != 0)
            throw std::invalid_argument("deploy_stream: expected one or more calibration sequences of " +
                                        std::to_string(input.size()) + " numbers, found " +
                                        std::to_string(sequences.size()) + " numbers");
        const float* const values = network.learnable_values().data();
        require_finite(network.learnable_values().first(Network::parameters), "parameters");
        require_finite(sequences, "calibration sequences");
        detail::stream_observation found{input.rows};
        require_finite(detail::stream_observer<steps>::run(values, frames_of(sequences), found),
                       "parameters and sequences");
        require_finite({&found.out_of_range, 1}, "parameters and sequences");

        write_word_steps(sequences);
        const std::vector<float> scaled = scaled_by_word_steps(network.learnable_values());
        require_finite(scaled, "parameters and sequences");
        std::vector<map_range> ranges;
        for (const auto& [lowest, highest] : found.ranges)
            ranges.push_back(map_range::of(lowest, highest));
        float* const of_steps = folded_.data() + input.channels;
        steps::fold(scaled.data(), of_steps);
        const map_range* next = ranges.data();
        const map_range output = steps::set_ranges(of_steps, map_range{}, next);
        if constexpr (!plan::writes_floats)
            output.write(folded_.data() + plan::output_range);
        round_weights(plan::layout(), folded_);
    }
    /// The folded numbers of the deployed stream; weights are whole multiples of their scales.
    [[nodiscard]] std::span<const float, plan::folded_elements> folded() const {
        return std::span<const float, plan::folded_elements>(folded_.data(), folded_.size());
    }

private:
    [[gnu::cold]] void write_word_steps(std::span<const float> sequences) {
        std::vector<float> largest(input.channels);
        for (std::size_t i = 0; i < sequences.size(); ++i) {
            float& of_feature = largest[i % input.size() / input.rows];
            of_feature = std::max(of_feature, std::abs(sequences[i]));
        }
        // A feature that is always zero takes the least step: its weights, which nothing has trained, must
        // not set the scales of filters.
        float least = std::numeric_limits<float>::max();
        for (const float of_feature : largest)
            least = of_feature > 0 ? std::min(least, of_feature) : least;
        if (least == std::numeric_limits<float>::max())
            least = 1;
        for (std::size_t f = 0; f < input.channels; ++f)
            folded_[f] = std::clamp((largest[f] > 0 ? largest[f] : least) * headroom / 32767, 1e-30F, 1e30F);
    }
    /// Parameters for features in steps of their words: weights of the first layer, [row][feature][tap] in
    /// every kind of layer that can be first, are multiplied by the step of their feature.
    [[gnu::cold]] std::vector<float> scaled_by_word_steps(std::span<const float> parameters) const {
        std::vector<float> scaled(parameters.begin(), parameters.end());
        const parameter weights = Network::describe().front();
        const std::size_t taps = weights.size / weights.extents[0] / input.channels;
        for (std::size_t i = 0; i < weights.size; ++i)
            scaled[weights.offset + i] *= folded_[i / taps % input.channels];
        return scaled;
    }
    /// From feature by feature to frame by frame.
    [[gnu::cold]] static std::vector<float> frames_of(std::span<const float> sequences) {
        std::vector<float> frames(sequences.size());
        for (std::size_t i = 0; i < sequences.size(); ++i) {
            const std::size_t sequence = i / input.size(), feature = i % input.size() / input.rows,
                              frame = i % input.rows;
            frames[sequence * input.size() + frame * input.channels + feature] = sequences[i];
        }
        return frames;
    }
    [[gnu::cold]] static void require_finite(std::span<const float> numbers, const char* what) {
        for (const float number : numbers)
            if (!(std::abs(number) <= detail::stream_observation::most))
                throw std::invalid_argument(std::string("deploy_stream: expected ") + what +
                                            " that give finite numbers up to 1e30, found " +
                                            detail::short_number(static_cast<double>(number)));
    }

    std::vector<float> folded_;
};

/// Deploys a trained network of sequences in 8 bits, for frames as they come. `sequences` are training
/// samples, which set the ranges. Throws std::invalid_argument as stream_calibration:
///
///     const auto stream = deploy_stream<eight_bit>(network, training_sequences);
template <class Format, class Network>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] deployed_stream<Network, eight_bit> deploy_stream(const Network& network,
                                                                std::span<const float> sequences) {
    return deployed_stream<Network, eight_bit>(stream_calibration<Network>(network, sequences).folded());
}

}} // namespace tactnet
