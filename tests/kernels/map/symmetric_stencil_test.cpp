#include <tactnet/kernels/map/symmetric_stencil.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <support/guarded_map.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

std::size_t apart(std::size_t a, std::size_t b) {
    return a > b ? a - b : b - a;
}

/// Against the sum written out in double; half of the rows are empty.
template <shape Shape>
void compare(extent2d reach) {
    CAPTURE(Shape.columns);
    CAPTURE(reach.columns);
    std::uint64_t state = Shape.size();
    std::vector<float> weights(100 * 100);
    for (float& each : weights)
        each = std::abs(support::draw(state)); // none negative: sums of positives have no cancellation
    const auto weight = [&](std::size_t i, std::size_t j) { return weights[i * 100 + j]; };
    support::guarded_map map(Shape.size(), NAN, 0);
    for (std::size_t y = 0; y < Shape.rows; ++y)
        for (std::size_t x = 0; x < Shape.columns; ++x)
            map.data()[y * Shape.columns + x] = y % 4 < 2 ? std::abs(support::draw(state)) : 0;
    const std::vector<float> given(map.data(), map.data() + Shape.size());
    symmetric_stencil<Shape> stencil(reach, weight);
    stencil.apply(map.data());
    CHECK(map.untouched());
    for (std::size_t y = 0; y < Shape.rows; ++y)
        for (std::size_t x = 0; x < Shape.columns; ++x) {
            double sum = 0;
            for (std::size_t i = 0; i < Shape.rows; ++i)
                for (std::size_t j = 0; j < Shape.columns; ++j)
                    if (apart(y, i) <= reach.rows && apart(x, j) <= reach.columns)
                        sum += static_cast<double>(weight(apart(y, i), apart(x, j))) *
                               static_cast<double>(given[i * Shape.columns + j]);
            const double terms = static_cast<double>((2 * reach.rows + 1) * (2 * reach.columns + 1));
            CHECK(std::abs(static_cast<double>(map.data()[y * Shape.columns + x]) - sum) <=
                  terms * 0x1p-24 * sum);
        }
}

TEST_CASE("symmetric_stencil: it is the sum written out") {
    compare<shape{28, 50}>(3);
    compare<shape{28, 50}>({27, 49});
    compare<shape{28, 50}>(0);
    compare<shape{5, 3}>({7, 9});
    compare<shape{1, 1}>(4);
    compare<shape{3, 150}>({1, 20});
    compare<shape{9, 8}>({2, 7});
}

TEST_CASE("symmetric_stencil: NaN and negative pressures count as zero, too large ones as the maximum") {
    constexpr float most = std::numeric_limits<float>::max();
    constexpr shape size{4, 20};
    symmetric_stencil<size> stencil(1,
                                    [](std::size_t i, std::size_t j) { return i + j == 0 ? 0.5f : 0.0625f; });
    std::vector<float> map(size.size(), 0.0f);
    map[0] = NAN, map[1] = -5, map[3] = 16, map[30] = INFINITY;
    stencil.apply(map.data());
    CHECK(map[0] == 0);
    CHECK(map[1] == 0);
    CHECK(map[2] == 1);
    CHECK(map[3] == 8);
    CHECK(map[30] == most / 2);
    CHECK(map[31] == most / 16);
    CHECK(map[75] == 0);
}

TEST_CASE("symmetric_stencil: negative weights leave nothing below zero") {
    constexpr shape size{3, 9};
    symmetric_stencil<size> stencil({0, 1}, [](std::size_t, std::size_t j) { return j == 0 ? 2.0f : -0.5f; });
    std::vector<float> map(size.size(), 0.0f);
    map[13] = 8;
    stencil.apply(map.data());
    CHECK(map[13] == 16);
    CHECK(map[12] == 0);
    CHECK(map[14] == 0);
}

} // namespace
