#pragma once

#include <tactnet/networks/normalisation.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/training/loss.hpp>
#include <tactnet/training/metrics.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Images of one size, stored one after the other as 8-bit counts, and the class of each. A view.
struct labelled_images {
    std::span<const std::uint8_t> pixels;
    std::span<const std::size_t> labels;
    std::size_t classes = 0;

    template <shape Shape>
    [[nodiscard]] std::span<const std::uint8_t, Shape.size()> image(std::size_t index) const {
        return std::span<const std::uint8_t, Shape.size()>(pixels.data() + index * Shape.size(),
                                                           Shape.size());
    }
};

/// Throws std::invalid_argument unless a network can tell the classes apart, every label is one of them, and
/// there are as many pixels as the labels need.
template <class Network>
void check_images(const labelled_images& images) {
    const auto refuse = [](const std::string& what, std::size_t expected, std::size_t found) {
        throw std::invalid_argument("images: expected " + what + " " + std::to_string(expected) + ", found " +
                                    std::to_string(found));
    };
    if (images.classes == 0 || images.classes > Network::outputs)
        refuse("classes, at least one and at most", Network::outputs, images.classes);
    if (images.pixels.size() != images.labels.size() * Network::input_shape.size())
        refuse("pixels:", images.labels.size() * Network::input_shape.size(), images.pixels.size());
    for (const std::size_t label : images.labels)
        if (label >= images.classes)
            refuse("a label below", images.classes, label);
}

struct evaluation {
    double loss = 0; ///< mean cross-entropy
    confusion_matrix confusion;
    std::vector<std::size_t> recognised; ///< class of each chosen image
};

/// Puts chosen images through a network. Only the first `images.classes` outputs count.
template <class Network>
[[nodiscard]] evaluation
evaluate(const Network& network, const normalisation<Network::input_shape>& normalise,
         const labelled_images& images, std::span<const std::size_t> chosen, thread_pool& threads) {
    constexpr std::size_t at_once = 64;
    check_images<Network>(images);
    typename Network::workspace space;
    network.prepare(threads, space);
    evaluation result{0, confusion_matrix(images.classes), {}};
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
            std::size_t best = 0;
            for (std::size_t c = 1; c < images.classes; ++c)
                if (out(i, c) > out(i, best))
                    best = c;
            result.recognised.push_back(best);
            result.confusion.add(labels[i], best);
        }
    }
    return result;
}

} // namespace TACTNET_ARCH
} // namespace tactnet
