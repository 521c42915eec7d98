#include <tactnet/simulation/effects/circuit/crosstalk.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdlib>
#include <limits>
#include <simulation/effect_frames.hpp>

using namespace tactnet;
using simulation::crosstalk;

TEST_CASE("crosstalk: one tactel shows on its four neighbours along the lines, also at the border") {
    constexpr shape size{4, 5};
    for (std::size_t at = 0; at < size.size(); ++at) {
        auto pressures = support::filled<size>(0);
        pressures.data()[at] = 1024;
        const auto read =
            support::after<size>(crosstalk{.along_row = 0.25, .along_column = 0.125}, pressures);
        for (std::size_t i = 0; i < size.size(); ++i) {
            const auto apart = [&](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
            const std::size_t rows = apart(at / size.columns, i / size.columns),
                              columns = apart(at % size.columns, i % size.columns);
            const float expected = rows + columns == 0  ? 1024.0f
                                   : rows + columns > 1 ? 0.0f
                                   : columns == 1       ? 256.0f
                                                        : 128.0f;
            CHECK(read.data()[i] == expected);
        }
    }
}
TEST_CASE("crosstalk: zero strength changes no bit, and finite readings never give NaN") {
    constexpr shape size{5, 7};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    support::check_changes_no_bit<size>(crosstalk{0, 0});
    support::check_changes_no_bit<size>(crosstalk{-1, nan});
    support::check_no_nan<size>(crosstalk{});
    support::check_no_nan<size>(crosstalk{1e300, 0});
    support::check_no_nan<size>(crosstalk{0, 1e300});
    CHECK(support::same_bits(support::after<size>(crosstalk{9, 9}, support::pressed<size>()),
                             support::after<size>(crosstalk{0.25, 0.25}, support::pressed<size>())));
}
