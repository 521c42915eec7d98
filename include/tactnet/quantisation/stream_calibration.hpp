#pragma once

#include <tactnet/deployment/eight_bit.hpp>
#include <tactnet/deployment/stream.hpp>
#include <tactnet/operators/lowering.hpp>
#include <tactnet/quantisation/activation_observer.hpp>
#include <tactnet/quantisation/graph.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Post-training quantisation of a network of sequences: ranges of features and maps from training sequences,
/// smaller where a few numbers lie far beyond all others and outputs lose less, weights rounded to the
/// nearest.
template <class Network>
class stream_calibration {
    using lowered = typename lowered_stream<Network, eight_bit>::type;
    using exact_layers = typename lowered_stream<Network>::type;
    using view = typename deployed_stream<Network, eight_bit>::view_type;
    static constexpr shape input = Network::input_shape;

public:
    /// Features may be so many times as large as on the training sequences before their words saturate.
    static constexpr float headroom = 4;

    /// `sequences` holds consecutive samples of the network, as for training: feature by feature, each from
    /// the first frame to the last. Throws std::invalid_argument unless there is at least one whole sequence,
    /// and if a number of the network or of a sequence, or what they give, is not finite.
    [[gnu::cold]] stream_calibration(const Network& network, std::span<const float> sequences)
        : folded_(view::folded_elements), graph_(calibration_graph_of<view>()) {
        if (sequences.empty() || sequences.size() % input.size() != 0)
            detail::throw_invalid_argument({"deploy_stream: expected one or more calibration sequences of ",
                                            input.size(), " numbers, found ", sequences.size(), " numbers"});
        const std::span<const float> values = network.learnable_values().first(Network::parameters);
        detail::require_finite(values, "parameters");
        detail::require_finite(sequences, "calibration sequences");
        const std::vector<float> frames = frames_of(sequences);
        std::vector<float> exact_folded(exact_layers::step::folded_elements);
        exact_layers::fold({values.data(), nullptr, 0}, exact_folded.data());
        detail::stream_observer observer(frames.size() / input.channels, input.rows);
        const std::vector<float> exact =
            observer.run(std::type_identity<typename exact_layers::step>{}, exact_folded.data(), frames);
        std::vector<std::size_t> halvings;
        for (const auto& [range, step] : graph_.observed_ranges()) {
            const detail::stream_observation& seen = observer.observed()[step];
            maps_.push_back(range), ranges_.emplace_back(seen.lowest, seen.highest);
            halvings.push_back(seen.halvings);
        }
        largest_ = largest_of(sequences);
        fold(network.learnable_values());
        // Errors of so many frames say enough.
        constexpr std::size_t enough = std::max<std::size_t>(4096 / input.rows, 1);
        const std::size_t sequence_count = frames.size() / input.size(),
                          used = std::min(sequence_count, enough), outputs = exact.size() / sequence_count;
        std::vector<float> some, right;
        for (std::size_t i = 0; i < used; ++i) {
            const std::size_t chosen = i * sequence_count / used;
            some.insert(some.end(), frames.begin() + static_cast<std::ptrdiff_t>(chosen * input.size()),
                        frames.begin() + static_cast<std::ptrdiff_t>((chosen + 1) * input.size()));
            right.insert(right.end(), exact.begin() + static_cast<std::ptrdiff_t>(chosen * outputs),
                         exact.begin() + static_cast<std::ptrdiff_t>((chosen + 1) * outputs));
        }
        choose_ranges(network, some, right, halvings_of_features(frames), halvings);
    }
    /// The folded numbers of the deployed stream; weights are whole multiples of their scales.
    [[nodiscard]] std::span<const float, view::folded_elements> folded() const {
        return std::span<const float, view::folded_elements>(folded_.data(), folded_.size());
    }

private:
    /// The largest magnitude of each feature.
    [[nodiscard]] [[gnu::cold]] static std::vector<float> largest_of(std::span<const float> sequences) {
        std::vector<float> largest(input.channels);
        for (std::size_t i = 0; i < sequences.size(); ++i) {
            float& of_feature = largest[i % input.size() / input.rows];
            of_feature = std::max(of_feature, std::abs(sequences[i]));
        }
        return largest;
    }
    /// The folded numbers of these ranges.
    [[gnu::cold]] void fold(std::span<const float> parameters) {
        write_word_steps();
        const std::vector<float> scaled = scaled_by_word_steps(parameters);
        detail::require_finite(scaled, "parameters and sequences");
        lowered::fold({scaled.data(), nullptr, 0}, folded_.data() + view::steps_folded);
        std::vector<map_range> ranges(graph_.ranges);
        for (std::size_t i = 0; i < maps_.size(); ++i)
            ranges[maps_[i]] = map_range::of(ranges_[i].first, ranges_[i].second);
        graph_.set_ranges(folded_.data(), ranges);
        round_weights(folded_layout_of<view>(), folded_);
    }
    [[nodiscard]] [[gnu::cold]] std::vector<std::size_t>
    halvings_of_features(std::span<const float> frames) const {
        std::vector<std::size_t> halvings;
        for (std::size_t f = 0; f < input.channels; ++f) {
            std::vector<float> of_feature;
            for (std::size_t i = f; i < frames.size(); i += input.channels)
                of_feature.push_back(frames[i]);
            halvings.push_back(detail::stream_observation(of_feature).halvings);
        }
        return halvings;
    }
    /// A few numbers far beyond all others would leave the others hardly any step of 8 or 16 bits. Where few
    /// are, smaller ranges are tried, one after the other, and kept if they lose a tenth less: the others
    /// saturate.
    [[gnu::cold]] void choose_ranges(const Network& network, std::span<const float> frames,
                                     std::span<const float> exact, std::span<const std::size_t> of_features,
                                     std::span<const std::size_t> of_maps) {
        const std::span<const float> parameters = network.learnable_values();
        const std::vector<float> largest = largest_;
        const std::vector<std::pair<double, double>> ranges = ranges_;
        std::vector<std::size_t> times(of_features.begin(), of_features.end());
        times.insert(times.end(), of_maps.begin(), of_maps.end());
        if (std::all_of(times.begin(), times.end(), [](std::size_t n) { return n == 0; }))
            return;
        // Of a feature, or of the map after all features.
        const auto error_with = [&](std::size_t range, std::size_t smaller) {
            const int n = static_cast<int>(smaller);
            if (range < input.channels) {
                largest_[range] = std::ldexp(largest[range], -n);
            } else {
                const auto& [lowest, highest] = ranges[range - input.channels];
                const double most = std::ldexp(std::max(-lowest, highest), -n);
                ranges_[range - input.channels] = {std::max(lowest, -most), std::min(highest, most)};
            }
            fold(parameters);
            return error_of(frames, exact);
        };
        std::vector<std::size_t> chosen(times.size());
        double least = error_of(frames, exact);
        // One small range shows little between large ones: all at once come first.
        const auto set_all = [&](const std::vector<std::size_t>& smaller) {
            double error = 0;
            for (std::size_t range = 0; range < times.size(); ++range)
                error = error_with(range, smaller[range]);
            return error;
        };
        if (const double error = set_all(times); error < 0.9 * least)
            least = error, chosen = times;
        else
            set_all(chosen);
        for (int round = 0; round < 2; ++round) // the best range of one depends on those of the others
            for (std::size_t range = 0; range < times.size(); ++range) {
                std::size_t best = chosen[range];
                double error = 0.9 * least;
                const std::size_t near = 3; // halvings
                for (std::size_t n = best - std::min(best, near);
                     n <= std::min(times[range], chosen[range] + near); ++n)
                    if (const double found = n == chosen[range] ? least : error_with(range, n); found < error)
                        error = found, best = n;
                if (times[range] > 0)
                    least = error_with(range, chosen[range] = best);
            }
    }
    /// The mean squared error of outputs after each frame, without the largest hundredth: frames beyond all
    /// others must not decide.
    [[nodiscard]] [[gnu::cold]] double error_of(std::span<const float> frames,
                                                std::span<const float> exact) const {
        const deployed_stream<Network, eight_bit> stream(folded());
        std::vector<float> found(exact.size());
        typename deployed_stream<Network, eight_bit>::state memory;
        for (std::size_t frame = 0; frame * stream.features < frames.size(); ++frame) {
            if (frame % input.rows == 0)
                memory = {};
            static_cast<void>(stream.step(
                frames.subspan(frame * stream.features).template first<stream.features>(), memory,
                std::span(found).subspan(frame * stream.outputs).template first<stream.outputs>()));
        }
        std::vector<double> squares(found.size());
        for (std::size_t o = 0; o < found.size(); ++o) {
            const double difference = static_cast<double>(found[o]) - static_cast<double>(exact[o]);
            squares[o] = difference * difference;
        }
        std::sort(squares.begin(), squares.end());
        squares.resize(squares.size() - squares.size() / 100);
        return std::accumulate(squares.begin(), squares.end(), 0.0) / static_cast<double>(squares.size());
    }
    [[gnu::cold]] void write_word_steps() {
        // A feature that is always zero takes the least step: its weights, which nothing has trained, must
        // not set the scales of filters.
        float least = std::numeric_limits<float>::max();
        for (const float of_feature : largest_)
            least = of_feature > 0 ? std::min(least, of_feature) : least;
        if (least == std::numeric_limits<float>::max())
            least = 1;
        for (std::size_t f = 0; f < input.channels; ++f)
            folded_[f] =
                std::clamp((largest_[f] > 0 ? largest_[f] : least) * headroom / 32767, 1e-30F, 1e30F);
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
    std::vector<float> folded_;
    detail::calibration_graph graph_;
    std::vector<float> largest_;                      ///< of each feature
    std::vector<std::size_t> maps_;                   ///< indices of the ranges that are observed
    std::vector<std::pair<double, double>> ranges_{}; ///< of each of them: lowest and highest number
};

/// Deploys a trained network of sequences in 8 bits, for frames as they come. `sequences` are training
/// samples, which set the ranges. Throws std::invalid_argument as stream_calibration, and for a
/// network whose weights are all zero:
///
///     const auto stream = deploy_stream<eight_bit>(network, training_sequences);
template <class Format, class Network>
    requires std::is_same_v<Format, eight_bit>
[[nodiscard]] deployed_stream<Network, eight_bit> deploy_stream(const Network& network,
                                                                std::span<const float> sequences) {
    detail::check_trained("deploy_stream", network);
    return deployed_stream<Network, eight_bit>(stream_calibration<Network>(network, sequences).folded());
}

}} // namespace tactnet
