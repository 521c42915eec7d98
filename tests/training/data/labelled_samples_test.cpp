#include <tactnet/training/data/labelled_samples.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

using namespace tactnet;

namespace {

constexpr shape size{1, 2};
constexpr std::array<std::size_t, 3> labels{0, 1, 1};
constexpr std::array<std::uint8_t, 6> pixels{1, 2, 3, 4, 255, 0};
constexpr std::array<float, 6> values{0.5F, -1, 2, 1e-30F, 4, 1e30F};

} // namespace

TEST_CASE("labelled_samples: images as their counts, features as they are") {
    const labelled_samples images = labelled_images{pixels, labels, 2},
                           features = labelled_features{values, labels, 2};
    CHECK(images.are_images());
    CHECK_FALSE(features.are_images());
    std::array<float, 2> of_image{}, of_features{};
    for (std::size_t i = 0; i < 3; ++i) {
        images.copy(i, of_image);
        features.copy(i, of_features);
        for (std::size_t e = 0; e < 2; ++e) {
            CHECK(of_image[e] == static_cast<float>(pixels[2 * i + e]));
            CHECK(of_features[e] == values[2 * i + e]);
        }
        CHECK(features.label(i) == labels[i]);
    }
    CHECK(features.size() == 3);
    CHECK(features.classes() == 2);
    CHECK(images.pixels().data() == pixels.data());
    CHECK_THROWS_AS(static_cast<void>(features.pixels()), std::logic_error);
}

TEST_CASE("labelled_samples: what does not fit a network is told with the numbers") {
    const auto told = [](const labelled_samples& samples, std::size_t outputs) {
        try {
            samples.check(size, outputs);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(told(labelled_images{pixels, labels, 2}, 2).empty());
    CHECK(told(labelled_images{{}, {}, 1}, 1).empty());
    CHECK(told(labelled_features{values, labels, 2}, 3).empty());
    CHECK(told(labelled_features{values, labels, 2}, 1) == "features: expected 1 to 1 classes, found 2");
    CHECK(told(labelled_images{pixels, labels, 0}, 3) == "images: expected 1 to 3 classes, found 0");
    CHECK(told(labelled_features{values, labels, 1}, 3) == "features: expected labels below 1, found 1");
    CHECK(told(labelled_features{std::span(values).first(5), labels, 2}, 2) ==
          "features: expected 6 numbers, found 5");
    CHECK(told(labelled_images{std::span(pixels).first(5), labels, 2}, 2) ==
          "images: expected 6 pixels, found 5");
}

TEST_CASE("labelled_samples: a feature that is no number is told with its place") {
    std::array<float, 6> broken = values;
    const labelled_samples features = labelled_features{broken, labels, 2};
    CHECK_NOTHROW(features.check_finite(size));
    CHECK_NOTHROW(labelled_samples(labelled_images{pixels, labels, 2}).check_finite(size));
    broken[3] = std::numeric_limits<float>::infinity();
    CHECK_THROWS_WITH_AS(features.check_finite(size),
                         "features: expected a finite number in sample 1, feature 1, found inf",
                         std::invalid_argument);
}
