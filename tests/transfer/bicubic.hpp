#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace support {

/// Keys' kernel by its formula, with the weights in single precision that the library has: [output][input].
inline std::vector<std::vector<double>> bicubic(std::size_t from, std::size_t to) {
    const auto kernel = [](double t) {
        t = std::abs(t);
        return t < 1   ? 1.5 * t * t * t - 2.5 * t * t + 1
               : t < 2 ? -0.5 * t * t * t + 2.5 * t * t - 4 * t + 2
                       : 0.0;
    };
    const double ratio = static_cast<double>(from) / static_cast<double>(to), wide = std::max(ratio, 1.0);
    std::vector<std::vector<double>> all;
    for (std::size_t o = 0; o < to; ++o) {
        const double centre = (static_cast<double>(o) + 0.5) * ratio - 0.5;
        std::vector<double> weights(from);
        double sum = 0;
        for (auto p = static_cast<long>(std::floor(centre - 2 * wide));
             static_cast<double>(p) <= centre + 2 * wide; ++p) {
            const auto size = static_cast<long>(from);
            const long m = ((p % (2 * size)) + 2 * size) % (2 * size), seen = m < size ? m : 2 * size - 1 - m;
            const double w = kernel((static_cast<double>(p) - centre) / wide);
            weights[static_cast<std::size_t>(seen)] += w, sum += w;
        }
        for (double& w : weights)
            w = static_cast<double>(static_cast<float>(w / sum));
        all.push_back(std::move(weights));
    }
    return all;
}

} // namespace support
