#include <tactnet/simulation/effects/circuit/dead_tactels.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <simulation/effect_frames.hpp>
#include <stdexcept>

using namespace tactnet;
using simulation::dead_tactels;

namespace {

constexpr shape size{28, 50};

support::frame<size> read(const dead_tactels& effect, std::uint64_t sensor = 1) {
    return support::after<size>(effect, support::filled<size>(1), {}, {.unit = {sensor}});
}

} // namespace

TEST_CASE("dead_tactels: the ones that are given, and no others") {
    const auto result = read({.single = 0, .tactels = {{3, 4}, {27, 49}}, .rows = {7}, .columns = {0, 11}});
    for (std::size_t row = 0; row < size.rows; ++row)
        for (std::size_t column = 0; column < size.columns; ++column) {
            const bool dead = (row == 3 && column == 4) || (row == 27 && column == 49) || row == 7 ||
                              column == 0 || column == 11;
            CHECK(result(row, column) == (dead ? 0 : 1));
        }
}
TEST_CASE("dead_tactels: as many as the probability, the same ones on the same sensor") {
    constexpr std::uint64_t sensors = 200;
    double tactels = 0, rows = 0, columns = 0;
    for (std::uint64_t sensor = 0; sensor < sensors; ++sensor) {
        const auto singles = read({.single = 0.05}, sensor);
        for (const float value : singles)
            tactels += value == 0;
        // A single tactel of chance could hide whether a line is dead.
        const auto lines = read({.single = 0, .row = 0.1, .column = 0.2}, sensor);
        for (std::size_t row = 0; row < size.rows; ++row) {
            bool dead = true;
            for (std::size_t column = 0; column < size.columns; ++column)
                dead = dead && lines(row, column) == 0;
            rows += dead;
        }
        for (std::size_t column = 0; column < size.columns; ++column) {
            bool dead = true;
            for (std::size_t row = 0; row < size.rows; ++row)
                dead = dead && lines(row, column) == 0;
            columns += dead;
        }
    }
    const auto check = [](double found, double n, double share) {
        CHECK(std::abs(found - n * share) < 5 * std::sqrt(n * share * (1 - share)));
    };
    check(tactels, sensors * size.size(), 0.05);
    check(rows, sensors * size.rows, 0.1);
    check(columns, sensors * size.columns, 0.2);
    CHECK(support::same_bits(read({.single = 0.05}, 9), read({.single = 0.05}, 9)));
    CHECK_FALSE(support::same_bits(read({.single = 0.05}, 9), read({.single = 0.05}, 10)));
}
TEST_CASE("dead_tactels: what is dead stays dead at a greater probability") {
    const auto some = read({.single = 0.05, .row = 0.05}), more = read({.single = 0.2, .row = 0.2});
    for (std::size_t i = 0; i < size.size(); ++i)
        CHECK(more.data()[i] <= some.data()[i]);
    for (const float value : read({.single = 1}))
        CHECK(value == 0);
}
TEST_CASE(
    "dead_tactels: zero probability changes no bit, no NaN, tactels outside of the array are rejected") {
    support::check_changes_no_bit<size>(dead_tactels{.single = 0});
    support::check_changes_no_bit<size>(
        dead_tactels{.single = -1, .row = std::numeric_limits<double>::quiet_NaN()});
    support::check_no_nan<shape{5, 7}>(dead_tactels{});
    CHECK_THROWS_WITH_AS(read({.rows = {28}}), "dead_tactels: expected a row below 28, found 28",
                         std::invalid_argument);
    CHECK_THROWS_AS(read({.columns = {50}}), std::invalid_argument);
    CHECK_THROWS_AS(read({.tactels = {{0, 50}}}), std::invalid_argument);
    CHECK_THROWS_AS(read({.tactels = {{28, 0}}}), std::invalid_argument);
}
