#include <tactnet/networks/recognition.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <numeric>

using namespace tactnet;

namespace {

constexpr shape image{2, 3, 2};
using pixels = std::array<int, image.size()>;

pixels reflected(const pixels& from, reflection how) {
    pixels to{};
    reflect_image(image, how, from.data(), to.data());
    return to;
}

} // namespace

TEST_CASE("reflection: rows, columns or both are exchanged, channel by channel") {
    pixels from{};
    std::iota(from.begin(), from.end(), 0);
    CHECK(reflected(from, {}) == from);
    CHECK(reflected(from, {.rows = true}) == pixels{3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8});
    CHECK(reflected(from, {.columns = true}) == pixels{2, 1, 0, 5, 4, 3, 8, 7, 6, 11, 10, 9});
    CHECK(reflected(from, {.rows = true, .columns = true}) == pixels{5, 4, 3, 2, 1, 0, 11, 10, 9, 8, 7, 6});
    for (const reflection how : all_reflections)
        CHECK(reflected(reflected(from, how), how) == from);
}

TEST_CASE("reflection: each of the four gives the same bits of the mean") {
    // Numbers whose sum depends on its order.
    const float a = 1e8f, b = 1.1f, c = -1e8f, d = 3.3f;
    const float mean = mean_of_reflections(a, b, c, d);
    CHECK(mean_of_reflections(b, a, d, c) == mean); // of the image with its rows exchanged
    CHECK(mean_of_reflections(c, d, a, b) == mean);
    CHECK(mean_of_reflections(d, c, b, a) == mean);
    CHECK(mean_of_reflections(1, 2, 3, 6) == 3);
}
