#pragma once

#include <tactnet/training/data/labelled_images.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <variant>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Features of samples, as many of each, stored one after the other, and the class of each: what other layers
/// have made of images, for those that are trained behind them. A view.
struct labelled_features {
    std::span<const float> values;
    std::span<const std::size_t> labels;
    std::size_t classes = 0;
};

/// What a network learns from and is tested on: images, or features. A view.
class labelled_samples {
public:
    labelled_samples(const labelled_images& images)
        : labelled_samples(images.pixels, images.labels, images.classes) {}
    labelled_samples(const labelled_features& features)
        : labelled_samples(features.values, features.labels, features.classes) {}
    labelled_samples(std::span<const std::uint8_t> pixels, std::span<const std::size_t> labels,
                     std::size_t classes)
        : labels_(labels), classes_(classes), numbers_(pixels) {}
    labelled_samples(std::span<const float> features, std::span<const std::size_t> labels,
                     std::size_t classes)
        : labels_(labels), classes_(classes), numbers_(features) {}

    [[nodiscard]] std::size_t size() const { return labels_.size(); }
    [[nodiscard]] std::size_t classes() const { return classes_; }
    [[nodiscard]] std::size_t label(std::size_t sample) const { return labels_[sample]; }
    [[nodiscard]] bool are_images() const { return numbers_.index() == 0; }

    /// The counts of all images. Throws std::logic_error for features.
    [[nodiscard]] std::span<const std::uint8_t> pixels() const {
        if (!are_images())
            throw std::logic_error("labelled_samples: expected images, found features");
        return std::get<0>(numbers_);
    }
    /// The numbers of one sample, as many as there is room for: counts, or features.
    void copy(std::size_t sample, std::span<float> to) const {
        std::visit(
            [&](const auto& numbers) {
                std::ranges::transform(numbers.subspan(sample * to.size(), to.size()), to.begin(),
                                       [](auto number) { return static_cast<float>(number); });
            },
            numbers_);
    }

    /// Throws std::invalid_argument unless a network of such inputs and so many outputs can learn from them:
    /// as `check_images`.
    void check(shape size, std::size_t outputs) const {
        const std::size_t numbers = std::visit([](const auto& all) { return all.size(); }, numbers_);
        detail::check_labelled(are_images() ? "images" : "features", are_images() ? "pixels" : "numbers",
                               numbers, labels_, classes_, size.size(), outputs);
    }

private:
    std::span<const std::size_t> labels_;
    std::size_t classes_;
    std::variant<std::span<const std::uint8_t>, std::span<const float>> numbers_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
