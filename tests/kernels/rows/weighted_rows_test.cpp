#include <tactnet/kernels/rows/weighted_rows.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

using namespace tactnet::kernels;

namespace {

/// Each term is rounded twice, and a sum at most once per row.
template <std::size_t Rows, std::size_t Columns>
void check_sums() {
    std::mt19937 random(Rows * 100 + Columns);
    std::normal_distribution<float> normal;
    const auto draw = [&](std::size_t count) {
        std::vector<float> values(count);
        for (float& value : values)
            value = normal(random);
        return values;
    };
    const auto weights = draw(Rows), rows = draw(Rows * Columns + 1), before = draw(Columns);
    auto sums = before;
    add_weighted_rows<Rows, Columns>(weights.data(), rows.data() + 1, sums.data()); // of any alignment
    for (std::size_t c = 0; c < Columns; ++c) {
        auto expected = static_cast<double>(before[c]);
        double magnitude = std::abs(expected);
        for (std::size_t r = 0; r < Rows; ++r) {
            const double term =
                static_cast<double>(weights[r]) * static_cast<double>(rows[r * Columns + c + 1]);
            expected += term;
            magnitude += std::abs(term);
        }
        constexpr double rounding = std::numeric_limits<float>::epsilon() / 2;
        CHECK(std::abs(static_cast<double>(sums[c]) - expected) <= (Rows + 2) * rounding * magnitude);
    }
}

} // namespace

TEST_CASE("add_weighted_rows: sums of rows of any length and number") {
    check_sums<1, 1>();
    check_sums<2, 3>();
    check_sums<7, 8>();
    check_sums<256, 16>();
    check_sums<257, 21>();
    check_sums<31, 40>();
    check_sums<9, 67>();
}
