#include <tactnet/training/data/labelled_samples.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <numeric>
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

TEST_CASE("labelled_images: an array for each image") {
    std::vector<std::array<std::uint8_t, size.size()>> arrays(2);
    arrays[1][5] = 7;
    const std::vector<std::size_t> labels{0, 1};
    const labelled_images images{arrays, labels, 2};
    CHECK(images.pixels.size() == 12);
    CHECK(images.pixels.data() == arrays[0].data());
    CHECK(images.image<size>(1)[5] == 7);
    CHECK_NOTHROW(labelled_samples(images).check(size, 2));
    const std::vector<std::array<std::uint8_t, size.size()>> none;
    CHECK(labelled_images{none, {}, 2}.pixels.empty());
}
