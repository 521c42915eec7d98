#pragma once

#include <tactnet/operators/convolution/reference.hpp>
#include <tactnet/quantisation/graph.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// Writes the first map of an image, exact or rounded to words. The folded numbers begin with the mean and
/// the steps per count of the words; the input is (count − mean) × scale.
[[gnu::cold]] inline void write_reference_input(const shape& input, std::span<const float> folded,
                                                float scale, const float* image, bool rounded, float* to) {
    const float steps = folded[input.size()];
    for (std::size_t e = 0; e < input.size(); ++e) {
        const std::size_t channel = e / input.area(), pixel = e % input.area();
        const float mean = folded[e];
        to[pixel * input.channels + channel] =
            rounded ? (std::nearbyint(image[e] * steps) - std::nearbyint(mean * steps)) * (scale / steps)
                    : (image[e] - mean) * scale;
    }
}

/// Executes a node of the calibration graph in single precision, exact or with every number rounded to 8
/// bits. Keeps the weights of a convolution in the order of use.
class node_executor {
public:
    /// `folded`: all folded numbers of the network. `rounded`: weights and outputs are rounded to 8 bits,
    /// with the ranges and scales among the folded numbers.
    [[gnu::cold]] node_executor(const calibration_graph& net, const graph_node& step,
                                std::span<const float> folded, bool rounded)
        : net_(net),
          step_(step),
          of_step_(folded.data() + step.folded),
          rounded_(rounded && net.maps[step.output].range != calibration_graph::none) {
        if (step.convolution != nullptr)
            convolution_.emplace(*step.convolution, of_step_, rounded);
    }
    /// Of a step that is one.
    [[nodiscard]] const convolution_reference& convolution() const { return *convolution_; }

    /// Reads maps of an image and writes one of them, whose range is `output`.
    [[gnu::cold]] void run(float* maps, const map_range& output) const {
        const shape to = net_.maps[step_.output].size;
        const float* const in = net_.map(maps, step_.input);
        float* const out = net_.map(maps, step_.output);
        if (convolution_)
            convolution_->run(in, net_.map(maps, step_.added), out, to);
        else
            step_.reference(of_step_, in, net_.map(maps, step_.added), out);
        if (!rounded_)
            return;
        const std::size_t first = convolution_ ? step_.convolution->map_offset : 0,
                          channels = convolution_ ? step_.convolution->filters : to.channels;
        for (std::size_t pixel = 0; pixel < to.area(); ++pixel)
            for (std::size_t c = first; c < first + channels; ++c) {
                float& number = out[pixel * to.channels + c];
                number = nearest(number, output);
            }
    }

private:
    /// A number rounded to a byte of the range.
    [[nodiscard]] static float nearest(float value, const map_range& range) {
        constexpr float largest_byte = 255;
        return (std::clamp(std::nearbyint(value / range.scale) + range.zero_point, 0.0f, largest_byte) -
                range.zero_point) *
               range.scale;
    }

    const calibration_graph& net_;
    const graph_node& step_;
    const float* of_step_;
    bool rounded_;
    std::optional<convolution_reference> convolution_;
};

}}} // namespace tactnet::detail
