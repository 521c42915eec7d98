#pragma once

#include <tactnet/kernels/response_rule.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Local response normalisation of one frame that lies pixel by pixel: the window runs along a pixel.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// `Stride` elements from one pixel to the next, in both maps. Zeros after the last channel stay zeros.
template <class Rule, std::size_t Stride>
void normalise_pixels(std::size_t pixels, const float* input, float* output) {
    constexpr std::size_t room = padded_size<float>(Stride);
    std::array<float, room + Rule::size> squares{};
    alignas(alignment) std::array<float, room> values{}, sums;
    const vector<float> share(static_cast<float>(Rule::share)), k(static_cast<float>(Rule::k));
    for (std::size_t p = 0; p < pixels; ++p, input += Stride, output += Stride) {
        for (std::size_t c = 0; c < Stride; ++c)
            squares[Rule::before + c] = input[c] * input[c];
        std::copy_n(input, Stride, values.begin());
        for (std::size_t c = 0; c < room; ++c) {
            float sum = squares[c];
            for (std::size_t i = 1; i < Rule::size; ++i)
                sum += squares[c + i];
            sums[c] = sum;
        }
        for (std::size_t c = 0; c < room; c += lanes<float>)
            store(values.data() + c,
                  load(values.data() + c) *
                      Rule::template power<float>(multiply_add<float>(load(sums.data() + c), share, k)));
        std::copy_n(values.begin(), Stride, output);
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
