#include <tactnet/simulation/effects/circuit/saturation.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <limits>
#include <simulation/effect_frames.hpp>

using namespace tactnet;
using simulation::saturation;

TEST_CASE("saturation: nothing above the limit, and nothing else changed") {
    constexpr shape size{28, 50};
    const auto pressures = support::pressed<size>();
    const auto read = support::after<size>(saturation{.limit = 20e3}, pressures);
    std::size_t above = 0;
    for (std::size_t i = 0; i < size.size(); ++i) {
        const bool over = pressures.data()[i] > 20e3f;
        above += over;
        CHECK(read.data()[i] == (over ? 20e3f : pressures.data()[i]));
    }
    CHECK(above > 100);
}
TEST_CASE(
    "saturation: an infinite limit changes no bit, finite readings never give NaN, and NaN is not hidden") {
    constexpr shape size{5, 7};
    support::check_changes_no_bit<size>(saturation{.limit = std::numeric_limits<double>::infinity()});
    support::check_no_nan<size>(saturation{});
}
