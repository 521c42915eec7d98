#include <tactnet/sensors/calibration.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>

#include <doctest/doctest.h>

#include <cmath>

using tactnet::tekscan_6077;

static_assert(tekscan_6077::extents == tactnet::shape{28, 50, 1});
static_assert(tekscan_6077::saturation_pressure == 34'000);
static_assert(tekscan_6077::tactels_per_area == 276'000);

TEST_CASE("tekscan_6077: the pitch is that of the published density, in whole micrometres") {
    CHECK(std::round(1e6 / std::sqrt(tekscan_6077::tactels_per_area)) ==
          std::round(tekscan_6077::pitch * 1e6));
    CHECK(tekscan_6077::pitch == 1.903e-3);
}

TEST_CASE("tekscan_6077: the last count is its saturation pressure") {
    CHECK(tactnet::calibration::for_6077().values().saturation_pressure == tekscan_6077::saturation_pressure);
}
