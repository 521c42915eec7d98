#include <tactnet/sensors/frame.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using tactnet::frame_view;
using tactnet::shape;

TEST_CASE("frame: cells in a size known when compiling") {
    const std::array<float, 6> cells{0, 1, 2, 3, 254, 255};
    const frame_view frame{1, 0.5, 2, 3, cells};
    CHECK(frame(1, 0) == 3);
    CHECK(frame(1, 1) == 254);
    const auto view = frame.as<shape{2, 3, 1}>();
    REQUIRE(view);
    CHECK((*view)(1, 2) == 255);
    CHECK(view->data() == cells.data());
    CHECK(!frame.as<shape{3, 2, 1}>());
    CHECK(!frame.as<shape{2, 2, 1}>());
    CHECK(!frame_view{1, {}, 2, 3, std::span(cells).first(5)}.as<shape{2, 3, 1}>());
}

TEST_CASE("frame: 8-bit counts, where the cells are") {
    std::array<float, 2> cells{7, 255};
    const frame_view frame{1, {}, 1, 2, cells};
    const auto counts = frame.counts<shape{1, 2, 1}>();
    REQUIRE(counts);
    CHECK((*counts)(0, 0) == 7);
    CHECK((*counts)(0, 1) == 255);
    CHECK(!frame.counts<shape{2, 1, 1}>());
    for (const float other : {255.5F, 256.F, -1.F, 0.5F, std::nanf("")}) {
        cells[1] = other;
        CHECK(!frame.counts<shape{1, 2, 1}>());
    }
}
