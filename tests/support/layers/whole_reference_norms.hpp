#pragma once

// What norms with moments of each frame, and of responses, must give in 8 bits. whole_reference.hpp includes
// it.

#include <tactnet/operators/sample_norms/eight_bit.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ratio>
#include <support/layers/whole_reference.hpp>
#include <vector>

namespace support {

/// Moments of whole numbers. What comes after them is rounded number by number: the square root and its
/// inverse, the normalised number, its product with the weight to 1/256 of a step, and the byte.
template <tactnet::shape Map, std::size_t Stride, unsigned Kind, std::size_t Groups, bool Rectified>
struct reference_step<tactnet::sample_norm_step<tactnet::eight_bit, Map, Stride, Kind, Groups, Rectified>> {
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

/// Sums of squares are whole. What comes after them is rounded number by number.
template <tactnet::shape Map, std::size_t Stride, std::size_t Size, class Alpha, class Beta, class K>
struct reference_step<tactnet::local_response_norm_step<
    tactnet::eight_bit, Map, Stride, tactnet::kernels::response_rule<Size, Alpha, Beta, K>>> {
    static float power(float x) { // x^−β
        const float root = std::sqrt(x);
        if (std::ratio_equal_v<Beta, std::ratio<3, 4>>) {
            const float product = root * std::sqrt(root);
            return 1 / product;
        }
        return 1 / (std::ratio_equal_v<Beta, std::ratio<1>> ? x : root);
    }
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        const reference_range input = reference_range::next(folded), output = reference_range::next(folded);
        const auto value = []<class Ratio>(Ratio) {
            return static_cast<double>(Ratio::num) / static_cast<double>(Ratio::den);
        };
        const double of_square = value(Alpha{}) / static_cast<double>(Size) * input.scale * input.scale,
                     k = value(K{});
        const auto margin = static_cast<float>(of_square * 1e24 > k ? std::max(k / of_square, 1e-24) : 1e24);
        const float quotient = power(static_cast<float>(k)) / power(margin),
                    factor = static_cast<float>(input.scale / output.scale) * quotient;
        whole_map result = in;
        for (std::size_t e = 0; e < in.whole.size(); ++e) {
            const std::size_t c = e % Map.channels;
            std::int64_t squares = 0;
            for (std::size_t i = 0; i < Map.channels; ++i)
                if (i + Size / 2 >= c && i <= c + (Size - 1) / 2) {
                    const std::int64_t distance = in.whole[e - c + i] - input.zero;
                    squares += distance * distance;
                }
            const float base = static_cast<float>(squares) + margin, of_base = power(base);
            const float factors = of_base * factor;
            result.whole[e] = reference_byte(in.whole[e] - input.zero, factors, output.zero, false);
        }
        return result;
    }
};

} // namespace support
