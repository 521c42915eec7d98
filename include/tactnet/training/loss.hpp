#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/tensor/batch.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Samples side by side as in a batch, `outputs` numbers of each in lane blocks.
struct logit_layout {
    std::size_t samples, outputs, lanes;

    [[nodiscard]] std::size_t operator()(std::size_t sample, std::size_t output) const {
        return (sample / lanes * outputs + output) * lanes + sample % lanes;
    }
    [[nodiscard]] std::size_t size() const { return detail::ceil_div(samples, lanes) * outputs * lanes; }
};

template <class T>
double softmax_cross_entropy(const logit_layout& at, const T* logits, std::span<const std::size_t> labels,
                             std::size_t classes, double smoothing, T* gradient) {
    std::fill_n(gradient, at.size(), T{});
    const auto count = static_cast<double>(at.samples);
    double total = 0;
    for (std::size_t sample = 0; sample < at.samples; ++sample) {
        const auto logit = [&](std::size_t c) { return static_cast<double>(logits[at(sample, c)]); };
        double largest = logit(0);
        for (std::size_t c = 1; c < classes; ++c)
            largest = std::max(largest, logit(c));
        double sum = 0;
        for (std::size_t c = 0; c < classes; ++c)
            sum += std::exp(logit(c) - largest);
        const double log_sum =
            std::log(sum); // of the distances from the largest, or a large logit would swallow it
        const double shared = labels[sample] < classes ? smoothing : 1;
        for (std::size_t c = 0; c < classes; ++c) {
            const double log_probability = logit(c) - largest - log_sum;
            const double wanted =
                shared / static_cast<double>(classes) + (c == labels[sample] ? 1 - shared : 0.0);
            if (wanted > 0) // a wanted share of zero costs nothing, even where the logarithm is −∞
                total -= wanted * log_probability;
            gradient[at(sample, c)] = static_cast<T>((std::exp(log_probability) - wanted) / count);
        }
    }
    return total / count;
}

} // namespace detail

/// Softmax with cross-entropy, in double and relative to the largest logit, without overflow or logarithms of
/// rounded probabilities. Only the first `classes` logits count. Label smoothing gives each class
/// `smoothing / classes`; an outlier, of a label that is no class, 1 / classes. Returns the mean over the
/// batch and writes its gradient, zero for other logits and for lanes without a sample.
template <class T, shape Shape, std::size_t Lanes>
double softmax_cross_entropy(batch_view<const T, Shape, Lanes> logits, std::span<const std::size_t> labels,
                             std::size_t classes, double smoothing, batch_view<T, Shape, Lanes> gradient) {
    return detail::softmax_cross_entropy({logits.samples(), Shape.size(), Lanes}, logits.data(), labels,
                                         classes, smoothing, gradient.data());
}

}} // namespace tactnet
