#include <tactnet/training/data/labelled_samples.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
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
    CHECK(told({pixels, labels, 2}, 2).empty());
    CHECK(told({values, labels, 2}, 2).empty());
    CHECK(told(labelled_features{values, labels, 2}, 3).empty());
    CHECK(told(labelled_features{values, labels, 2}, 1) ==
          "features: expected classes, at least one and at most 1, found 2");
    CHECK(told(labelled_features{values, labels, 1}, 3) == "features: expected a label below 1, found 1");
    CHECK(told(labelled_features{std::span(values).first(5), labels, 2}, 2) ==
          "features: expected numbers: 6, found 5");
    CHECK(told(labelled_images{std::span(pixels).first(5), labels, 2}, 2) ==
          "images: expected pixels: 6, found 5");
}
