#include <tactnet/simulation/effects/circuit/quantisation.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <simulation/effect_frames.hpp>
#include <type_traits>

using namespace tactnet;
using simulation::quantisation;
using simulation::quantisation_levels;

namespace {

constexpr shape size{1, 4001};

/// Every count against rounding in double precision. Nearer to the middle between two counts than float can
/// resolve, either is right.
template <std::size_t Levels>
void check_levels() {
    support::frame<size> pressures;
    for (std::size_t i = 0; i < size.size(); ++i)
        pressures.data()[i] = static_cast<float>(i) * 10;
    const auto counts = support::after<size>(quantisation_levels<Levels>{.full_scale = 34e3}, pressures);
    for (std::size_t i = 0; i < size.size(); ++i) {
        const double exact = std::min(static_cast<double>(i) * 10 / 34e3, 1.0) * (Levels - 1);
        const double count = static_cast<double>(counts.data()[i]);
        CHECK(count == std::round(count));
        CHECK(std::abs(count - exact) <= 0.5 + 4 * 0x1p-24 * exact);
    }
    CHECK(counts.data()[3400] == Levels - 1);
    CHECK(counts.data()[4000] == Levels - 1);
}

} // namespace

TEST_CASE("quantisation: the nearest count, of 8 bits and of the paper's 15 levels") {
    static_assert(std::is_same_v<quantisation<8>, quantisation_levels<256>>);
    check_levels<256>();
    check_levels<15>();
    check_levels<2>();
    check_levels<65536>();
}
TEST_CASE("quantisation: counts whatever comes") {
    constexpr shape few{1, 5};
    constexpr float most = std::numeric_limits<float>::max(), nan = std::numeric_limits<float>::quiet_NaN();
    const float given[]{-1e30f, -0.0f, most, std::numeric_limits<float>::infinity(), nan},
        expected[]{0, 0, 255, 255, 0};
    support::frame<few> values;
    std::copy(std::begin(given), std::end(given), values.begin());
    const auto counts = support::after<few>(quantisation<8>{}, values);
    for (std::size_t i = 0; i < few.size(); ++i)
        CHECK(counts.data()[i] == expected[i]);
}
