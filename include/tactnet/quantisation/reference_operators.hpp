#pragma once

#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/layers/activation_function.hpp>
#include <tactnet/quantisation/graph.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

// Operators of the calibration graph, as plain loops in single precision; node_executor has convolutions.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

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

[[gnu::cold]] inline void reference_norm(const graph_node& step, const float* folded, const float* in,
                                         float* out) {
    const std::size_t channels = step.from.channels;
    for (std::size_t e = 0; e < step.from.size(); ++e) {
        out[e] = folded[e % channels] * in[e] + folded[channels + e % channels];
        if (step.rectified)
            out[e] = std::max(out[e], 0.0f);
    }
}
template <class Function>
[[gnu::cold]] void reference_activation(const graph_node& step, const float*, const float* in, float* out) {
    for (std::size_t e = 0; e < step.from.size(); ++e)
        out[e] = Function::value(in[e]);
}
[[gnu::cold]] inline void reference_square_root(const graph_node& step, const float*, const float* in,
                                                float* out) {
    for (std::size_t e = 0; e < step.from.size(); ++e)
        out[e] = static_cast<float>(std::sqrt(std::max(static_cast<double>(in[e]), 0.0) + step.offset) -
                                    std::sqrt(step.offset));
}
[[gnu::cold]] inline void reference_max_pool(const graph_node& step, const float*, const float* in,
                                             float* out) {
    const sliding_window& w = step.window;
    const shape from = step.from, to = step.to;
    const auto pixels = [](std::size_t index, std::size_t kernel, std::size_t stride, std::size_t before,
                           std::size_t size) {
        const std::size_t begin = index * stride;
        return std::pair(std::max(begin, before) - before, std::min(begin + kernel - before, size));
    };
    for (std::size_t e = 0; e < to.size(); ++e) {
        const std::size_t pixel = e / to.channels, c = e % to.channels;
        const auto [top, bottom] = pixels(pixel / to.columns, w.kernel.rows, w.stride.rows, w.top, from.rows);
        const auto [left, right] =
            pixels(pixel % to.columns, w.kernel.columns, w.stride.columns, w.left, from.columns);
        out[e] = -std::numeric_limits<float>::infinity();
        for (std::size_t y = top; y < bottom; ++y)
            for (std::size_t x = left; x < right; ++x)
                out[e] = std::max(out[e], in[(y * from.columns + x) * from.channels + c]);
    }
}
[[gnu::cold]] inline void reference_average_pool(const graph_node& step, const float*, const float* in,
                                                 float* out) {
    const shape from = step.from;
    step.means.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t divisor) {
        for (std::size_t c = 0; c < from.channels; ++c) {
            float sum = 0;
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x)
                    sum += in[(y * from.columns + x) * from.channels + c];
            out[o * from.channels + c] = sum / static_cast<float>(divisor);
        }
    });
}
/// The operator of a step with a function `reference`.
template <class Step>
void reference_own_step(const graph_node&, const float* folded, const float* in, float* out) {
    Step::reference(folded, in, out);
}
[[gnu::cold]] inline void reference_softmax(std::span<float> numbers) {
    kernels::softmax_of<float>(numbers, numbers);
}

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet
