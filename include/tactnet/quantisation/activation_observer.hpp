#pragma once

#include <tactnet/quantisation/node_executor.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
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

}}} // namespace tactnet::detail
