#include <tactnet/simulation/saturation.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <limits>

namespace {

using namespace tactnet::simulation;

constexpr tactnet::shape size{1, 5};
using values = std::array<float, size.size()>;

values through(const saturation& effect, values pressures) {
    saturation::bound<size>(effect, {}).apply(tactnet::tensor_view<float, size>(pressures), {});
    return pressures;
}

TEST_CASE("no pressure is above the limit, and those below it do not change") {
    const float endless = std::numeric_limits<float>::infinity();
    CHECK(through({.limit = 100}, {-3, 0, 99.5f, 100, 101}) == values{-3, 0, 99.5f, 100, 100});
    CHECK(through({.limit = 100}, {endless, 1e30f, -endless, 1, 2}) == values{100, 100, -endless, 1, 2});
    CHECK(through({}, {33.9e3f, 34.1e3f, 0, 0, 0}) == values{33.9e3f, 34e3f, 0, 0, 0});
}

TEST_CASE("an endless limit changes no bit") {
    const values some{-0.0f, 1e-30f, 34e3f, 1e30f, std::numeric_limits<float>::infinity()};
    CHECK(through({.limit = std::numeric_limits<double>::infinity()}, some) == some);
}

} // namespace
