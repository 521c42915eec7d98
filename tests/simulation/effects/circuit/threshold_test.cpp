#include <tactnet/simulation/effects/circuit/threshold.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <simulation/effect_frames.hpp>

using namespace tactnet;
using simulation::threshold;

TEST_CASE("threshold: what is below it is zero, what is not stays") {
    constexpr shape size{1, 6};
    const auto above = std::nextafter(100.0f, 200.0f), below = std::nextafter(100.0f, 0.0f);
    const float given[]{-5, 0, below, 100, above, 1e30f}, expected[]{0, 0, 0, 100, above, 1e30f};
    support::frame<size> values;
    std::copy(std::begin(given), std::end(given), values.begin());
    const auto result = support::after<size>(threshold{100}, values);
    for (std::size_t i = 0; i < size.size(); ++i)
        CHECK(result.data()[i] == expected[i]);
}
TEST_CASE("threshold: zero and impossible thresholds change no bit, and finite readings never give NaN") {
    constexpr shape size{5, 7};
    support::check_changes_no_bit<size>(threshold{0});
    support::check_changes_no_bit<size>(threshold{-1});
    support::check_changes_no_bit<size>(threshold{std::numeric_limits<double>::quiet_NaN()});
    support::check_no_nan<size>(threshold{});
}
