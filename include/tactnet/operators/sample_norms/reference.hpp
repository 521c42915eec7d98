#pragma once

#include <tactnet/operators/sample_norms/eight_bit.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <shape Map, std::size_t Stride, unsigned Kind, std::size_t Groups, bool Rectified>
void sample_norm_step<eight_bit, Map, Stride, Kind, Groups, Rectified>::reference(const float* from,
                                                                                  const float* in,
                                                                                  float* out) {
    constexpr std::size_t channels = Map.channels / Groups;
    const auto together = [&](std::size_t first_pixel, std::size_t pixels, std::size_t first) {
        const auto each = [&](const auto& body) {
            for (std::size_t pixel = first_pixel; pixel < first_pixel + pixels; ++pixel)
                for (std::size_t c = first; c < first + channels; ++c)
                    body(pixel * Map.channels + c, per_element ? c * Map.area() + pixel : c);
        };
        double mean = 0, variance = static_cast<double>(from[2 * weights]);
        each([&](std::size_t e, std::size_t) { mean += static_cast<double>(in[e]); });
        mean /= static_cast<double>(values_together);
        each([&](std::size_t e, std::size_t) {
            const double distance = static_cast<double>(in[e]) - mean;
            variance += distance * distance / static_cast<double>(values_together);
        });
        each([&](std::size_t e, std::size_t w) {
            const double value = (static_cast<double>(in[e]) - mean) / std::sqrt(variance);
            out[e] = static_cast<float>(value * static_cast<double>(from[w]) +
                                        static_cast<double>(from[weights + w]));
            if (Rectified)
                out[e] = std::max(out[e], 0.0f);
        });
    };
    if constexpr (of_pixels)
        for (std::size_t pixel = 0; pixel < Map.area(); ++pixel)
            together(pixel, 1, 0);
    else
        for (std::size_t group = 0; group < Groups; ++group)
            together(0, Map.area(), group * channels);
}

template <shape Map, std::size_t Stride, std::size_t Size, class Alpha, class Beta, class K>
void local_response_norm_step<eight_bit, Map, Stride,
                              kernels::response_rule<Size, Alpha, Beta, K>>::reference(const float*,
                                                                                       const float* in,
                                                                                       float* out) {
    for (std::size_t pixel = 0; pixel < Map.area(); ++pixel, in += Map.channels, out += Map.channels)
        for (std::size_t c = 0; c < Map.channels; ++c) {
            double squares = 0;
            const std::size_t end = std::min(c + rule::behind + 1, Map.channels);
            for (std::size_t i = c - std::min(c, rule::before); i < end; ++i)
                squares += static_cast<double>(in[i]) * static_cast<double>(in[i]);
            out[c] = static_cast<float>(static_cast<double>(in[c]) *
                                        std::pow(rule::k + rule::share * squares, -rule::beta));
        }
}

}} // namespace tactnet
