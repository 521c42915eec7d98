#pragma once

#include <tactnet/operators/local_response_norm/eight_bit.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

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
