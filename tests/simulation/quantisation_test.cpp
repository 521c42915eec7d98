#include <tactnet/simulation/quantisation.hpp>

#include <doctest/doctest.h>

#include <array>
#include <limits>
#include <type_traits>

namespace {

using namespace tactnet::simulation;

template <class Converter>
float count_of(float pressure, const Converter& converter = {}) {
    std::array<float, 1> value{pressure};
    typename Converter::template bound<tactnet::shape{1, 1}>(converter, {})
        .apply(tactnet::tensor_view<float, tactnet::shape{1, 1}>(value), {});
    return value[0];
}

static_assert(std::is_same_v<quantisation<4>, quantisation_levels<16>>);
static_assert(std::is_same_v<quantisation<16>, quantisation_levels<65536>>);

TEST_CASE("counts are whole, the nearest, and the last one is full scale") {
    const quantisation_levels<11> tenths{.full_scale = 1000};
    CHECK(count_of(0, tenths) == 0);
    CHECK(count_of(49, tenths) == 0);
    CHECK(count_of(51, tenths) == 1);
    CHECK(count_of(149, tenths) == 1);
    CHECK(count_of(949, tenths) == 9);
    CHECK(count_of(951, tenths) == 10);
    CHECK(count_of(1000, tenths) == 10);
    CHECK(count_of<quantisation<8>>(34e3f) == 255);
    CHECK(count_of<quantisation<16>>(34e3f) == 65535);
}

TEST_CASE("what is below zero, beyond full scale or no number has a count too") {
    const float endless = std::numeric_limits<float>::infinity();
    CHECK(count_of<quantisation<8>>(-100) == 0);
    CHECK(count_of<quantisation<8>>(-endless) == 0);
    CHECK(count_of<quantisation<8>>(36e3f) == 255);
    CHECK(count_of<quantisation<8>>(endless) == 255);
    CHECK(count_of<quantisation<8>>(std::numeric_limits<float>::quiet_NaN()) == 0);
    CHECK(count_of(100, quantisation<8>{.full_scale = 0}) == 255);
    CHECK(count_of(0, quantisation<8>{.full_scale = 0}) == 0);
}

} // namespace
