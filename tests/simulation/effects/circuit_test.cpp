#include <tactnet/simulation/effects/circuit/conversion.hpp>
#include <tactnet/simulation/effects/circuit/wiring.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <simulation/effect_frames.hpp>
#include <stdexcept>
#include <support/same_bits.hpp>
#include <type_traits>

namespace {

using namespace tactnet;
using simulation::crosstalk;
using simulation::dead_tactels;
using simulation::noise;
using simulation::quantisation;
using simulation::quantisation_levels;
using simulation::saturation;
using simulation::threshold;

TEST_CASE("crosstalk: one tactel shows on its four neighbours along the lines, also at the border") {
    constexpr shape small{4, 5};
    for (std::size_t at = 0; at < small.size(); ++at) {
        auto pressures = support::filled<small>(0);
        pressures.data()[at] = 1024;
        const auto read =
            support::after<small>(crosstalk{.along_row = 0.25, .along_column = 0.125}, pressures);
        for (std::size_t i = 0; i < small.size(); ++i) {
            const auto apart = [&](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
            const std::size_t rows = apart(at / small.columns, i / small.columns),
                              columns = apart(at % small.columns, i % small.columns);
            const float expected = rows + columns == 0  ? 1024.0f
                                   : rows + columns > 1 ? 0.0f
                                   : columns == 1       ? 256.0f
                                                        : 128.0f;
            CHECK(read.data()[i] == expected);
        }
    }
}

TEST_CASE("crosstalk: a neighbour gives a quarter of its reading at most") {
    constexpr shape small{5, 7};
    CHECK(support::same_bits(support::after<small>(crosstalk{9, 9}, support::pressed<small>()),
                             support::after<small>(crosstalk{0.25, 0.25}, support::pressed<small>())));
}

constexpr shape size{28, 50};

support::frame<size> read(const dead_tactels& effect, std::uint64_t sensor = 1) {
    return support::after<size>(effect, support::filled<size>(1), {}, {.unit = {sensor}});
}

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

TEST_CASE("dead_tactels: tactels outside of the array are rejected") {
    CHECK_THROWS_WITH_AS(read({.rows = {28}}), "dead_tactels: expected a row below 28, found 28",
                         std::invalid_argument);
    CHECK_THROWS_AS(read({.columns = {50}}), std::invalid_argument);
    CHECK_THROWS_AS(read({.tactels = {{0, 50}}}), std::invalid_argument);
    CHECK_THROWS_AS(read({.tactels = {{28, 0}}}), std::invalid_argument);
}

TEST_CASE("noise: has the mean and deviation of its parameters") {
    const auto check = [](const noise& effect, double pressure, double deviation) {
        constexpr std::uint32_t frames = 50;
        double sum = 0, squares = 0;
        for (std::uint32_t frame = 0; frame < frames; ++frame)
            for (const float reading : support::after<size>(
                     effect, support::filled<size>(static_cast<float>(pressure)), {.frame = frame})) {
                const double error = static_cast<double>(reading) - pressure;
                sum += error, squares += error * error;
            }
        constexpr double n = size.size() * frames;
        CHECK(std::abs(sum / n) < 5 * deviation / std::sqrt(n));
        CHECK(std::abs(squares / n / (deviation * deviation) - 1) < 5 * std::sqrt(2 / n));
    };
    check({.additive = 100, .relative = 0}, 0, 100);
    check({.additive = 100, .relative = 0}, 20e3, 100);
    check({.additive = 0, .relative = 0.05}, 20e3, 1000);
    check({.additive = 300, .relative = 0.04}, 1e4, 500);
}

TEST_CASE("noise: every seed, frame and tactel has its own, the same whenever it is drawn") {
    const auto drawn = [](std::uint64_t seed, std::uint32_t frame) {
        return support::after<size>(noise{.additive = 1, .relative = 0}, support::filled<size>(0),
                                    {.seed = seed, .frame = frame});
    };
    const auto first = drawn(1, 0);
    CHECK(support::same_bits(first, drawn(1, 0)));
    const auto correlation = [&](const support::frame<size>& other, std::size_t apart) {
        double sum = 0;
        for (std::size_t i = 0; i + apart < size.size(); ++i)
            sum += static_cast<double>(first.data()[i]) * static_cast<double>(other.data()[i + apart]);
        return sum / std::sqrt(static_cast<double>(size.size()));
    };
    for (const auto& other : {drawn(2, 0), drawn(1, 1)})
        CHECK(std::abs(correlation(other, 0)) < 5);
    for (const std::size_t apart : {1u, 49u, 50u, 51u, 100u})
        CHECK(std::abs(correlation(first, apart)) < 5);
}

TEST_CASE("noise: the same bits with every instruction set") {
    const auto readings = support::after<size>(noise{}, support::pressed<size>(), {.seed = 3, .frame = 4});
    std::uint64_t hash = 0xcbf29ce484222325; // Fowler, Noll and Vo's
    for (const float reading : readings)
        hash = (hash ^ std::bit_cast<std::uint32_t>(reading)) * 0x100000001b3;
    CHECK(hash == 907740452739619058u);
}

constexpr shape steps{1, 4001};

/// Every count against rounding in double precision. Nearer to the middle between two counts than float can
/// resolve, either is right.
template <std::size_t Levels>
void check_levels() {
    support::frame<steps> pressures;
    for (std::size_t i = 0; i < steps.size(); ++i)
        pressures.data()[i] = static_cast<float>(i) * 10;
    const auto counts = support::after<steps>(quantisation_levels<Levels>{.full_scale = 34e3}, pressures);
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const double exact = std::min(static_cast<double>(i) * 10 / 34e3, 1.0) * (Levels - 1);
        const double count = static_cast<double>(counts.data()[i]);
        CHECK(count == std::round(count));
        CHECK(std::abs(count - exact) <= 0.5 + 4 * 0x1p-24 * exact);
    }
    CHECK(counts.data()[3400] == Levels - 1);
    CHECK(counts.data()[4000] == Levels - 1);
}

TEST_CASE("quantisation: the nearest count, of 8 bits and of the paper's 15 levels") {
    static_assert(std::is_same_v<quantisation<8>, quantisation_levels<256>>);
    check_levels<256>();
    check_levels<15>();
    check_levels<2>();
    check_levels<65536>();
}

TEST_CASE("quantisation: counts whatever comes") {
    constexpr shape odd{1, 5};
    constexpr float most = std::numeric_limits<float>::max(), nan = std::numeric_limits<float>::quiet_NaN();
    const float given[]{-1e30f, -0.0f, most, std::numeric_limits<float>::infinity(), nan},
        expected[]{0, 0, 255, 255, 0};
    support::frame<odd> values;
    std::copy(std::begin(given), std::end(given), values.begin());
    const auto counts = support::after<odd>(quantisation<8>{}, values);
    for (std::size_t i = 0; i < odd.size(); ++i)
        CHECK(counts.data()[i] == expected[i]);
}

TEST_CASE("saturation: nothing above the limit, and nothing else changed") {
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

TEST_CASE("threshold: what is below it is zero, what is not stays") {
    constexpr shape few{1, 6};
    const auto above = std::nextafter(100.0f, 200.0f), below = std::nextafter(100.0f, 0.0f);
    const float given[]{-5, 0, below, 100, above, 1e30f}, expected[]{0, 0, 0, 100, above, 1e30f};
    support::frame<few> values;
    std::copy(std::begin(given), std::end(given), values.begin());
    const auto result = support::after<few>(threshold{100}, values);
    for (std::size_t i = 0; i < few.size(); ++i)
        CHECK(result.data()[i] == expected[i]);
}

} // namespace
