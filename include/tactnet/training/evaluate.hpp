#pragma once

#include <tactnet/networks/normalisation.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/training/data/labelled_samples.hpp>
#include <tactnet/training/data/sample_batch.hpp>
#include <tactnet/training/loss.hpp>
#include <tactnet/training/metrics.hpp>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What a network makes of labelled samples.
struct evaluation {
    double loss = 0; ///< mean cross-entropy
    confusion_matrix confusion;
    std::vector<std::size_t> recognised; ///< class of each chosen sample
};

namespace detail {

/// `logits` puts a batch of inputs through a network.
inline evaluation evaluate(std::span<const float> mean, float scale, std::size_t outputs,
                           const labelled_samples& samples, std::span<const std::size_t> chosen,
                           const std::function<void(const sample_batch&, sample_batch&)>& logits) {
    constexpr std::size_t at_once = 64;
    evaluation result{0, confusion_matrix(samples.classes()), {}};
    std::vector<float> sample(mean.size()), of_classes(samples.classes());
    for (std::size_t first = 0; first < chosen.size(); first += at_once) {
        const std::size_t count = std::min(at_once, chosen.size() - first);
        sample_batch in(mean.size(), count), out(outputs, count), gradient(outputs, count);
        std::vector<std::size_t> labels(count);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t index = chosen[first + i];
            samples.copy(index, sample);
            for (std::size_t e = 0; e < mean.size(); ++e)
                sample[e] = (sample[e] - mean[e]) * scale;
            in.set(i, sample);
            labels[i] = samples.label(index);
        }
        logits(in, out);
        const double loss = softmax_cross_entropy<float>({count, outputs, sample_batch::lanes}, out.data(),
                                                         labels, samples.classes(), 0.0, gradient.data());
        result.loss += loss * static_cast<double>(count) / static_cast<double>(chosen.size());
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t c = 0; c < samples.classes(); ++c)
                of_classes[c] = out(i, c);
            const std::size_t best = first_largest(of_classes);
            result.recognised.push_back(best);
            result.confusion.add(labels[i], best);
        }
    }
    return result;
}

} // namespace detail

/// Puts chosen images, or features, through a network. Only as many outputs count as there are classes. Where
/// logits are not finite, neither is the loss, and the recognised classes mean nothing. Throws as
/// `labelled_samples::check`.
template <class Network>
[[nodiscard]] evaluation
evaluate(const Network& network, const normalisation<Network::input_shape>& normalise,
         const labelled_samples& samples, std::span<const std::size_t> chosen, thread_pool& threads) {
    samples.check(Network::input_shape, Network::outputs);
    typename Network::workspace space;
    network.prepare(threads, space);
    return detail::evaluate(
        normalise.mean.view().elements(), normalise.scale, Network::outputs, samples, chosen,
        [&](const sample_batch& in, sample_batch& out) {
            network.logits(threads, space, {in.data(), in.samples()}, {out.data(), out.samples()});
        });
}

} // namespace TACTNET_ARCH
} // namespace tactnet
