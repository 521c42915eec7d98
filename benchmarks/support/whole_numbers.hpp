#pragma once

#include "described_network.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

// What other libraries need of a network in 8 bits: the largest numbers that its maps hold on some frames,
// and its weights in whole numbers.

namespace benchmark {

/// The largest magnitude of each map, by plain loops.
class ranges {
public:
    ranges(const described_network& network, std::span<const std::uint8_t> frames)
        : largest(network.maps().size()) {
        const std::size_t size = network.maps().front().size();
        for (std::size_t first = 0; first < frames.size(); first += size)
            see(network, frames.subspan(first, size));
        for (const operation& o : network.operations()) // branches side by side have one scale
            for (const std::size_t branch : o.inputs)
                largest[branch] = largest[o.output];
    }
    std::vector<float> largest;

private:
    using map = std::vector<float>;

    void see(const described_network& network, std::span<const std::uint8_t> frame) {
        std::vector<map> maps(network.maps().size());
        maps[0].assign(frame.begin(), frame.end());
        for (const operation& o : network.operations()) {
            switch (o.what) {
            case operation::kind::convolution:
                maps[o.output] = convolved(o, maps[o.input], maps[o.output]);
                break;
            case operation::kind::pool:
                maps[o.output] = pooled(o, maps[o.input]);
                break;
            case operation::kind::dense:
                continue; // the last one, whose outputs are floats
            case operation::kind::average:
                continue; // the last one: adds nothing to the largest numbers
            case operation::kind::concatenation:
                for (const std::size_t branch : o.inputs)
                    maps[o.output].insert(maps[o.output].end(), maps[branch].begin(), maps[branch].end());
                break;
            case operation::kind::relu:
                throw std::invalid_argument(
                    "ranges: expected convolutions, pools, concatenations and dense layers");
            }
            for (const float value : maps[o.output])
                largest[o.output] = std::max(largest[o.output], std::abs(value));
        }
    }
    template <class Use>
    static void each_tap(const operation& o, std::size_t y, std::size_t x, const Use& use) {
        const tactnet::sliding_window& w = o.window;
        for (std::size_t r = 0; r < w.kernel.rows; ++r)
            for (std::size_t c = 0; c < w.kernel.columns; ++c) {
                const std::size_t row = y * w.stride.rows + r, column = x * w.stride.columns + c;
                if (row >= w.top && row - w.top < o.from.rows && column >= w.left &&
                    column - w.left < o.from.columns)
                    use(r * w.kernel.columns + c, (row - w.top) * o.from.columns + column - w.left);
            }
    }
    static map convolved(const operation& o, const map& in, const map& other) {
        map out(o.to.size());
        const std::size_t area = o.window.kernel.area();
        for (std::size_t f = 0; f < o.to.channels; ++f)
            for (std::size_t pixel = 0; pixel < o.to.area(); ++pixel) {
                float sum = o.bias[f] + (o.accumulates ? other[f * o.to.area() + pixel] : 0.0f);
                each_tap(o, pixel / o.to.columns, pixel % o.to.columns, [&](std::size_t tap, std::size_t at) {
                    for (std::size_t c = 0; c < o.from.channels; ++c)
                        sum += o.weights[(f * o.from.channels + c) * area + tap] * in[c * o.from.area() + at];
                });
                out[f * o.to.area() + pixel] = o.relu ? std::max(sum, 0.0f) : sum;
            }
        return out;
    }
    static map pooled(const operation& o, const map& in) {
        map out(o.to.size(), -std::numeric_limits<float>::infinity());
        for (std::size_t c = 0; c < o.to.channels; ++c)
            for (std::size_t pixel = 0; pixel < o.to.area(); ++pixel)
                each_tap(o, pixel / o.to.columns, pixel % o.to.columns, [&](std::size_t, std::size_t at) {
                    float& most = out[c * o.to.area() + pixel];
                    most = std::max(most, in[c * o.from.area() + at]);
                });
        return out;
    }
};

/// What one of each map's bytes is worth, where all maps but the logits hold nothing below zero.
/// `largest_logit` is what the last byte stands for.
[[nodiscard]] inline std::vector<float> scales_of(const described_network& network, const ranges& seen,
                                                  float largest_logit) {
    std::vector<float> scales(network.maps().size(), 1);
    for (const operation& o : network.operations())
        scales[o.output] = o.bias.empty()                       ? scales[o.input]
                           : &o == &network.operations().back() ? largest_logit / 127
                                                                : seen.largest[o.output] / 255;
    return scales;
}

/// Weights and biases in whole numbers, and what one of a sum of each filter is worth.
struct whole_numbers {
    std::vector<std::int8_t> weights;
    std::vector<std::int32_t> bias;
    std::vector<float> units;
};
inline whole_numbers quantised(const operation& o, float input_scale) {
    whole_numbers whole;
    const std::size_t of_one = o.weights.size() / o.bias.size();
    for (std::size_t f = 0; f < o.bias.size(); ++f) {
        const float* const weights = o.weights.data() + f * of_one;
        float largest = 1e-20f;
        for (std::size_t i = 0; i < of_one; ++i)
            largest = std::max(largest, std::abs(weights[i]));
        for (std::size_t i = 0; i < of_one; ++i)
            whole.weights.push_back(
                static_cast<std::int8_t>(std::lrint(127 * static_cast<double>(weights[i] / largest))));
        whole.units.push_back(largest / 127 * input_scale);
        whole.bias.push_back(static_cast<std::int32_t>(
            std::lrint(static_cast<double>(o.bias[f]) / static_cast<double>(whole.units.back()))));
    }
    return whole;
}

} // namespace benchmark
