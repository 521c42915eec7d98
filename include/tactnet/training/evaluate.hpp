#pragma once

#include <tactnet/networks/normalisation.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/training/labelled_images.hpp>
#include <tactnet/training/loss.hpp>
#include <tactnet/training/metrics.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What a network makes of labelled images.
struct evaluation {
    double loss = 0; ///< mean cross-entropy
    confusion_matrix confusion;
    std::vector<std::size_t> recognised; ///< class of each chosen image
};

/// Puts chosen images through a network. Only the first `images.classes` outputs count. Where logits are not
/// finite, neither is the loss, and the recognised classes mean nothing. Throws as `check_images`.
template <class Network>
[[nodiscard]] evaluation
evaluate(const Network& network, const normalisation<Network::input_shape>& normalise,
         const labelled_images& images, std::span<const std::size_t> chosen, thread_pool& threads) {
    constexpr std::size_t at_once = 64;
    check_images<Network>(images);
    typename Network::workspace space;
    network.prepare(threads, space);
    evaluation result{0, confusion_matrix(images.classes), {}};
    std::vector<float> logits(images.classes);
    for (std::size_t first = 0; first < chosen.size(); first += at_once) {
        const std::size_t count = std::min(at_once, chosen.size() - first);
        typename Network::input_batch in(count);
        typename Network::output_batch out(count), gradient(count);
        std::vector<std::size_t> labels(count);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t index = chosen[first + i];
            in.set(i, normalise(images.template image<Network::input_shape>(index)));
            labels[i] = images.labels[index];
        }
        network.logits(threads, space, in, out);
        const auto mean = softmax_cross_entropy(out.as_const(), std::span<const std::size_t>(labels),
                                                images.classes, 0.0, gradient.view());
        result.loss += mean * static_cast<double>(count) / static_cast<double>(chosen.size());
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t c = 0; c < images.classes; ++c)
                logits[c] = out(i, c);
            const std::size_t best = first_largest(logits);
            result.recognised.push_back(best);
            result.confusion.add(labels[i], best);
        }
    }
    return result;
}

} // namespace TACTNET_ARCH
} // namespace tactnet
