#pragma once

// What norms with moments of each frame must give in 8 bits. whole_reference.hpp includes it.

#include <tactnet/deployment/eight_bit/steps/sample_norm.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <support/layers/whole_reference.hpp>
#include <vector>

namespace support {

/// Moments of whole numbers. What comes after them is rounded number by number: the square root and its
/// inverse, the normalised number, its product with the weight to 1/256 of a step, and the byte.
template <tactnet::shape Map, std::size_t Stride, unsigned Kind, std::size_t Groups, bool Rectified,
          class Products>
struct reference_step<tactnet::sample_norm_step<tactnet::eight_bit, Map, Stride, Kind, Groups, Rectified>,
                      Products> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        constexpr auto kind = static_cast<tactnet::sample_norm_kind>(Kind);
        constexpr bool per_element = kind == tactnet::sample_norm_kind::frame,
                       of_pixels = kind == tactnet::sample_norm_kind::pixels;
        const std::size_t weights = per_element ? Map.size() : Map.channels;
        const float *const biases = folded + weights, *at = biases + weights + 1;
        const auto epsilon = static_cast<double>(at[-1]);
        const reference_range input = reference_range::next(at), output = reference_range::next(at);
        // The numbers that are normalised together.
        const std::size_t in_group = Map.channels / Groups;
        const auto together = [&](std::size_t e) {
            return of_pixels ? e / Map.channels : e % Map.channels / in_group;
        };
        const std::size_t count = of_pixels ? Map.channels : in_group * Map.area();
        std::vector<std::int64_t> sums(Map.size()), squares(Map.size());
        for (std::size_t e = 0; e < in.whole.size(); ++e)
            sums[together(e)] += in.whole[e], squares[together(e)] += in.whole[e] * in.whole[e];
        const double in_steps = static_cast<double>(count) / input.scale, parts = 256 / output.scale;
        const auto margin = static_cast<float>(std::clamp(epsilon * in_steps * in_steps, 1e-30, 1e38));

        whole_map result = in;
        const auto n = static_cast<std::int64_t>(count);
        for (std::size_t e = 0; e < in.whole.size(); ++e) {
            const std::size_t c = e % Map.channels, w = per_element ? c * Map.area() + e / Map.channels : c;
            const std::int64_t sum = sums[together(e)], spread = n * squares[together(e)] - sum * sum;
            const float deviation = std::sqrt(static_cast<float>(spread) + margin), factor = 1 / deviation;
            const float normalised = static_cast<float>(n * in.whole[e] - sum) * factor;
            const float product =
                normalised *
                static_cast<float>(std::clamp(static_cast<double>(folded[w]) * parts, -1e38, 1e38));
            const double most = 0x1p21,
                         bias = std::clamp(static_cast<double>(biases[w]) * parts, -most, most);
            const double of_parts =
                std::nearbyint(std::clamp(static_cast<double>(product), -most, most)) + std::nearbyint(bias);
            result.whole[e] =
                reference_byte(static_cast<std::int64_t>(of_parts), 1.0f / 256, output.zero, Rectified);
        }
        return result;
    }
};

} // namespace support
