#include <tactnet/training/data/labelled_images.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

using namespace tactnet;

namespace {
constexpr shape size{2, 3};
}

TEST_CASE("labelled_images: an image by its number") {
    std::vector<std::uint8_t> pixels(3 * size.size());
    std::iota(pixels.begin(), pixels.end(), std::uint8_t{0});
    const std::vector<std::size_t> labels{0, 1, 1};
    const labelled_images images{pixels, labels, 2};
    const auto last = images.image<size>(2);
    static_assert(last.extent == 6);
    CHECK(last.front() == 12);
    CHECK(last.back() == 17);
}

TEST_CASE("labelled_images: what does not fit a network is told with the numbers") {
    const std::vector<std::uint8_t> pixels(3 * size.size());
    const std::vector<std::size_t> labels{0, 1, 3};
    const auto told = [](const labelled_images& images, std::size_t outputs) {
        try {
            check_images(images, size, outputs);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(told({pixels, labels, 4}, 4).empty());
    CHECK(told({pixels, labels, 4}, 9).empty());
    CHECK(told({{}, {}, 1}, 1).empty());
    CHECK(told({pixels, labels, 4}, 3) == "images: expected classes, at least one and at most 3, found 4");
    CHECK(told({pixels, labels, 0}, 3) == "images: expected classes, at least one and at most 3, found 0");
    CHECK(told({pixels, labels, 3}, 4) == "images: expected a label below 3, found 3");
    CHECK(told({std::span(pixels).first(17), labels, 4}, 4) == "images: expected pixels: 18, found 17");
}
