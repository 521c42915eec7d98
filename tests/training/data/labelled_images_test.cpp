#include <tactnet/training/data/labelled_images.hpp>

#include <doctest/doctest.h>

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
