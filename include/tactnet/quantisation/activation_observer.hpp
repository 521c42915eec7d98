#pragma once

#include <tactnet/deployment/eight_bit/layout.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/operators/residual/step.hpp>
#include <tactnet/operators/sequence/step.hpp>
#include <tactnet/quantisation/node_executor.hpp>
#include <tactnet/tensor/aligned.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

// Runs a network on images in single precision: observes the range of each map, and the outputs with which
// those of a network in 8 bits are compared.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// Writes the outputs of the network in 8 bits with these folded numbers, for consecutive images; false if it
/// rejects one.
using run_quantised = bool (*)(std::span<const float> folded, std::span<const float> images,
                               std::span<float> to);

/// Larger numbers are rejected, as deploy does in single precision: derived from the largest float, 3.4 ·
/// 10³⁸, with room for sums over scaled inputs.
inline constexpr float largest_number = 1e30f;

[[noreturn, gnu::cold, gnu::noinline]] inline void refuse_calibration_image(std::size_t which) {
    throw_invalid_argument({"deploy: expected calibration images that the network recognises, found number ",
                            which, " of those taken broken"});
}

/// Observes the range of each map, and the outputs, of a network with exact weights.
///
/// If the network ends in a softmax, the outputs are probabilities. An image that is classified with near
/// certainty then has little influence on ranges: errors of its logits hardly move its probabilities, and
/// images between two classes decide alone. To calibrate on logits, remove the softmax: the folded numbers
/// are the same.
class activation_observer {
public:
    /// More images change ranges too little to justify the time. Chosen, not derived: the search runs all of
    /// these images sixteen times for each map.
    static constexpr std::size_t max_observed = 256;

    /// `folded`: the mean frame, two numbers for the words, then the numbers of all steps. The input is
    /// (count − mean) × scale. Of more images than `max_observed`, evenly spaced ones are observed.
    [[gnu::cold]] activation_observer(const calibration_graph& net, std::span<const float> folded,
                                      float scale, std::span<const float> images)
        : count_(images.size() / net.maps[0].size.size()) {
        check(net.maps[0].size.size(), images);
        choose(net.maps[0].size.size(), images);
        observe(net, folded, scale);
    }
    /// The minimum of all maps with this range, at most 0.
    [[nodiscard]] double lowest(std::size_t range) const { return static_cast<double>(lowest_[range]); }
    /// The maximum of all maps with this range, at least 0.
    [[nodiscard]] double highest(std::size_t range) const { return static_cast<double>(highest_[range]); }
    /// The outputs of each observed image, [channel][row][column].
    [[nodiscard]] std::span<const float> outputs() const { return outputs_; }

    /// The mean squared error of the outputs in 8 bits on the observed images.
    [[nodiscard]] [[gnu::cold]] double error_of(run_quantised recognise,
                                                std::span<const float> folded) const {
        std::vector<float> found(outputs_.size());
        if (!recognise(folded, images_, found))
            return std::numeric_limits<double>::infinity();
        double sum = 0;
        for (std::size_t o = 0; o < found.size(); ++o) {
            const double difference = static_cast<double>(found[o]) - static_cast<double>(outputs_[o]);
            sum += difference * difference;
        }
        return sum / static_cast<double>(found.size());
    }

private:
    [[gnu::cold]] static void check(std::size_t size, std::span<const float> images) {
        for (std::size_t e = 0; e < images.size(); ++e)
            if (!(std::abs(images[e]) <= largest_number))
                refuse_calibration_image(e / size);
    }
    /// The index of the i-th observed image among all images.
    [[nodiscard]] std::size_t observed(std::size_t i) const {
        return i * count_ / std::min(count_, max_observed);
    }
    [[gnu::cold]] void choose(std::size_t size, std::span<const float> images) {
        const std::size_t used = std::min(count_, max_observed);
        images_ = std::vector<float>(used * size);
        for (std::size_t i = 0; i < used; ++i)
            std::copy_n(images.data() + observed(i) * size, size, images_.data() + i * size);
    }
    [[gnu::cold]] void observe(const calibration_graph& net, std::span<const float> folded, float scale) {
        lowest_ = std::vector<float>(net.ranges), highest_ = std::vector<float>(net.ranges);
        const shape input = net.maps[0].size;
        const feature_map& last = net.maps[net.nodes.back().output];
        const std::size_t images = images_.size() / input.size();
        outputs_ = std::vector<float>(images * last.size.size());
        // The weights of a node are packed once for this many images, whose maps are kept. Chosen: packing
        // then costs little per image, and sixteen images need little memory.
        constexpr std::size_t together = 16;
        std::vector<float> maps(std::min(images, together) * net.numbers);
        for (std::size_t first = 0; first < images; first += together) {
            const std::size_t some = std::min(images - first, together);
            for (std::size_t i = 0; i < some; ++i)
                write_reference_input(input, folded, scale, images_.data() + (first + i) * input.size(),
                                      false, maps.data() + i * net.numbers);
            for (const graph_node& step : net.nodes) {
                const node_executor executor(net, step, folded, false);
                for (std::size_t i = 0; i < some; ++i)
                    executor.run(maps.data() + i * net.numbers, {});
            }
            for (std::size_t i = 0; i < some; ++i) {
                observe_maps(net, maps.data() + i * net.numbers);
                keep_outputs(maps.data() + i * net.numbers + last.begin, last.size, first + i);
            }
        }
    }
    [[gnu::cold]] void observe_maps(const calibration_graph& net, const float* maps) {
        for (const feature_map& map : net.maps) {
            if (map.range == calibration_graph::none || map.range == 0)
                continue;
            float &lowest = lowest_[map.range], &highest = highest_[map.range];
            for (std::size_t e = map.begin; e < map.begin + map.size.size(); ++e)
                lowest = std::min(lowest, maps[e]), highest = std::max(highest, maps[e]);
        }
    }
    [[gnu::cold]] void keep_outputs(const float* map, shape size, std::size_t image) {
        float* to = outputs_.data() + image * size.size();
        for (std::size_t channel = 0; channel < size.channels; ++channel)
            for (std::size_t pixel = 0; pixel < size.area(); ++pixel) {
                const float output = map[pixel * size.channels + channel];
                if (!(std::abs(output) <= std::numeric_limits<float>::max()))
                    refuse_calibration_image(observed(image));
                *to++ = output;
            }
    }

    std::size_t count_;
    std::vector<float> images_, outputs_;
    std::vector<float> lowest_, highest_; ///< per range
};

// Runs the steps of a stream in single precision over whole recordings, for calibration.

[[gnu::cold]] inline void require_finite(std::span<const float> numbers, const char* what) {
    constexpr float most = 1e30F;
    for (const float number : numbers)
        if (!(std::abs(number) <= most))
            throw_invalid_argument({"deploy_stream: expected ", what,
                                    " that give finite numbers up to 1e30, found ",
                                    short_number(static_cast<double>(number))});
}

/// What calibration needs to know about some numbers.
struct stream_observation {
    double lowest = 0, highest = 0;
    std::size_t halvings =
        0; ///< the largest n for which at most a hundredth exceed the largest magnitude ÷ 2ⁿ

    [[gnu::cold]] explicit stream_observation(std::span<const float> numbers) {
        const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
        lowest = static_cast<double>(*least), highest = static_cast<double>(*most);
        constexpr std::size_t most_halvings = 24;
        float largest = std::max(std::abs(*least), std::abs(*most));
        for (; halvings < most_halvings && largest > 0; ++halvings) {
            largest /= 2;
            const auto beyond = std::count_if(numbers.begin(), numbers.end(),
                                              [&](float number) { return std::abs(number) > largest; });
            if (100 * static_cast<std::size_t>(beyond) > numbers.size())
                break;
        }
    }
};

class stream_observer {
    using map = std::vector<float>; ///< over all recordings, frame after frame

public:
    /// `frames`: of all recordings, each of which has `in_recording`.
    stream_observer(std::size_t frames, std::size_t in_recording)
        : frames_(frames), in_recording_(in_recording) {}
    /// The outputs of each step, in the order of their folded numbers.
    [[nodiscard]] const std::vector<stream_observation>& observed() const { return observed_; }

    /// Returns the map that a step writes. It adds to `added` if it ends a main branch.
    template <class... Steps>
    map run(std::type_identity<step_chain<Steps...>>, const float* folded, map in,
            const map* added = nullptr) {
        ((in = run(std::type_identity<Steps>{}, folded, in, added), folded += Steps::folded_elements), ...);
        return in;
    }
    /// The skip comes first when it runs, and last among the folded numbers.
    template <class Main, class Skip, std::size_t Stride>
    map run(std::type_identity<residual_step<Main, Skip, Stride>>, const float* folded, const map& in,
            const map*) {
        stream_observer of_skip(frames_, in_recording_);
        const map added =
            of_skip.run(std::type_identity<Skip>{}, folded + Main::folded_elements, in, nullptr);
        map out = run(std::type_identity<Main>{}, folded, in, &added);
        observed_.insert(observed_.end(), of_skip.observed_.begin(), of_skip.observed_.end());
        return out;
    }
    map run(std::type_identity<no_step>, const float*, const map& in, const map*) { return in; }
    template <class Step>
    map run(std::type_identity<Step>, const float* folded, const map& in, const map* added) {
        constexpr std::size_t outputs = Step::output.channels;
        const std::size_t features = in.size() / frames_;
        aligned_vector<float> packed(Step::packed_elements + 1), x(pad_to_cache_line(features)),
            y(pad_to_cache_line(Step::output_stride)), memory(Step::workspace_elements + 1);
        Step::pack(folded, packed.data());
        map out(frames_ * outputs);
        state_of_step<0, Step> states;
        for (std::size_t frame = 0; frame < frames_; ++frame) {
            if (frame % in_recording_ == 0)
                states = {};
            std::copy_n(in.data() + frame * features, features, x.data());
            if (added != nullptr)
                std::copy_n(added->data() + frame * outputs, outputs, y.data());
            run_step<0, Step>(packed.data(), x.data(), y.data(), memory.data(), states);
            std::copy_n(y.data(), outputs, out.data() + frame * outputs);
        }
        require_finite(out, "parameters and sequences");
        observed_.emplace_back(out);
        return out;
    }

private:
    std::size_t frames_, in_recording_;
    std::vector<stream_observation> observed_;
};

}}} // namespace tactnet::detail
