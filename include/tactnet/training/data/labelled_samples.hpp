#pragma once

#include <tactnet/tensor/shape.hpp>
#include <tactnet/training/data/labelled_images.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
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
        : labels_(images.labels), classes_(images.classes), numbers_(images.pixels), taken_(images.taken) {}
    labelled_samples(const labelled_features& features)
        : labels_(features.labels), classes_(features.classes), numbers_(features.values) {}

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
    /// Of images, those of which they were made.
    [[nodiscard]] const images_as_taken& taken() const { return taken_; }
    /// The numbers of one sample, as many as there is room for: counts, or features.
    void copy(std::size_t sample, std::span<float> to) const {
        std::visit(
            [&](const auto& numbers) {
                const auto of_sample = numbers.subspan(sample * to.size(), to.size());
                std::transform(of_sample.begin(), of_sample.end(), to.begin(),
                               [](auto number) { return static_cast<float>(number); });
            },
            numbers_);
    }

    /// Throws std::invalid_argument unless a network of such inputs and so many outputs can tell the classes
    /// apart, every label is one of them, and there are as many numbers as the labels need.
    void check(shape input, std::size_t outputs) const {
        const std::size_t expected = size() * input.size(),
                          found = std::visit([](const auto&numbers) { return numbers.size(); }, numbers_);
        if (classes_ == 0 || classes_ > outputs)
            refuse("1 to " + std::to_string(outputs) + " classes", std::to_string(classes_));
        if (found != expected)
            refuse(std::to_string(expected) + (are_images() ? " pixels" : " numbers"), std::to_string(found));
        if (taken_.given() && taken_.seen != input)
            refuse("images as taken that are reduced to " + text_of(input), text_of(taken_.seen));
        if (taken_.given() && taken_.pixels.size() != size() * taken_.taken.size())
            refuse(std::to_string(size() * taken_.taken.size()) + " pixels of images as taken",
                   std::to_string(taken_.pixels.size()));
        for (const std::size_t label : labels_)
            if (label >= classes_)
                refuse("labels below " + std::to_string(classes_), std::to_string(label));
    }
    /// Throws std::invalid_argument for a feature that is not a finite number. `input` is the shape of a
    /// sample, as above.
    void check_finite(shape input) const {
        if (are_images())
            return;
        const std::span<const float> features = std::get<1>(numbers_);
        for (std::size_t i = 0; i < features.size(); ++i)
            if (!std::isfinite(features[i]))
                refuse("a finite number in sample " + std::to_string(i / input.size()) + ", feature " +
                           std::to_string(i % input.size()),
                       std::to_string(features[i]));
    }

private:
    [[noreturn]] void refuse(const std::string& expected, const std::string& found) const {
        throw std::invalid_argument((are_images() ? "images: expected " : "features: expected ") + expected +
                                    ", found " + found);
    }

    static std::string text_of(const shape& s) {
        return std::to_string(s.rows) + " x " + std::to_string(s.columns) + " x " +
               std::to_string(s.channels);
    }

    std::span<const std::size_t> labels_;
    std::size_t classes_;
    std::variant<std::span<const std::uint8_t>, std::span<const float>> numbers_;
    images_as_taken taken_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
