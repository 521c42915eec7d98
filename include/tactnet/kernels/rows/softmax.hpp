#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// exp(x) / Σ exp(x), from the largest logit down so that nothing overflows. Sums in double. May work in
/// place.
template <class T>
void softmax_of(std::span<const T> logits, std::span<T> probabilities) noexcept {
    const double largest = static_cast<double>(*std::max_element(logits.begin(), logits.end()));
    double sum = 0;
    for (const T logit : logits)
        sum += std::exp(static_cast<double>(logit) - largest);
    for (std::size_t i = 0; i < logits.size(); ++i)
        probabilities[i] = static_cast<T>(std::exp(static_cast<double>(logits[i]) - largest) / sum);
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
