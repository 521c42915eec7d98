#include <tactnet/simulation/effects/mechanics.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

namespace {

using namespace tactnet::simulation;
using tactnet::shape;
using tactnet::tensor;

constexpr shape size{28, 50};
using map = tensor<float, size>;
constexpr double cell = 1.9e-3;

map through(const elastic_pad& pad, const map& before) {
    elastic_pad::bound<size> bound(pad, {.cell = cell});
    map pressures = before;
    bound.apply(pressures.view(), {});
    return pressures;
}
map pressed_cell(std::size_t row, std::size_t column, float pressure) {
    map result;
    result(row, column) = pressure;
    return result;
}
double sum(const map& pressures) {
    double result = 0;
    for (const float each : pressures)
        result += static_cast<double>(each);
    return result;
}

static_assert(in_place_effect<elastic_pad::bound<size>, size> && effect<elastic_pad>);

TEST_CASE(
    "pad: the shares of an endless array add up to one, and so do their waves to the transfer function") {
    for (const double poisson : {0.0, 0.3, 0.5})
        for (const double thickness : {0.01, 0.3, 1.0, 2.5}) {
            CAPTURE(poisson);
            CAPTURE(thickness);
            const pad_shares shares(thickness, poisson);
            double whole = 0, wave = 0;
            const double k = 0.7; // along one axis, per cell
            for (int i = -60; i <= 60; ++i)
                for (int j = -60; j <= 60; ++j) {
                    const double share =
                        shares(static_cast<std::size_t>(std::abs(i)), static_cast<std::size_t>(std::abs(j)));
                    whole += share;
                    wave += share * std::cos(k * j);
                }
            CHECK(whole == doctest::Approx(1).epsilon(2e-5));
            // Averaged over two cells: Σ over the waves k + 2πn of sinc² times the transfer function.
            double expected = 0;
            for (int n = -400; n <= 400; ++n) {
                const double q = k + 2 * std::numbers::pi * n, sinc = std::sin(q / 2) / (q / 2);
                expected += sinc * sinc * layer_transfer(std::abs(q) * thickness, poisson);
            }
            CHECK(wave == doctest::Approx(expected).epsilon(2e-5));
        }
}

TEST_CASE(
    "pad: no force is lost in the middle of the array, and pressure spreads the more the thicker the pad") {
    double before = 1;
    for (const double thickness : {1e-4, 3e-4, 1e-3, 2e-3, 3e-3}) {
        CAPTURE(thickness);
        const map film = through({.thickness = thickness, .poisson = 0.48}, pressed_cell(14, 25, 1000));
        CHECK(sum(film) == doctest::Approx(1000).epsilon(1e-6));
        CHECK(static_cast<double>(film(14, 25)) / 1000 < before);
        before = static_cast<double>(film(14, 25)) / 1000;
        for (const float pressure : film)
            CHECK(pressure >= 0);
        for (std::size_t i = 0; i < 10; ++i) { // as far to all four sides
            CHECK(film(14, 25 + i) == doctest::Approx(film(14, 25 - i)).epsilon(1e-6));
            CHECK(film(14 + i, 25) == doctest::Approx(film(14, 25 + i)).epsilon(1e-6));
        }
    }
}

TEST_CASE("pad: an even pressure stays what it is, but at the rim of the array force is lost") {
    map even;
    for (float& pressure : even)
        pressure = 2000;
    const map film = through({.thickness = 1e-3, .poisson = 0.48}, even);
    CHECK(film(14, 25) == doctest::Approx(2000).epsilon(1e-5));
    CHECK(film(14, 0) < 1900);
    CHECK(film(14, 0) > 1000);
    CHECK(film(0, 0) < film(14, 0));
}

TEST_CASE("pad: one of no thickness changes no bit") {
    map pressures = pressed_cell(3, 4, 123.456f);
    pressures(5, 6) = NAN, pressures(7, 8) = -1, pressures(9, 10) = INFINITY;
    for (const double thickness : {0.0, -1.0, 1e-10, std::numeric_limits<double>::quiet_NaN()}) {
        const map film = through({.thickness = thickness}, pressures);
        for (std::size_t i = 0; i < size.size(); ++i)
            CHECK(std::bit_cast<std::uint32_t>(film.data()[i]) ==
                  std::bit_cast<std::uint32_t>(pressures.data()[i]));
    }
    // One that is hardly there hardly changes anything.
    const map film = through({.thickness = 1e-7, .poisson = 0.5}, pressed_cell(3, 4, 1000));
    CHECK(film(3, 4) == doctest::Approx(1000).epsilon(1e-3));
}

TEST_CASE("pad: through an endlessly thick pad nothing is felt") {
    for (const double poisson : {0.0, 0.3, 0.5}) {
        for (const double thickness : {1e3, 1e300, std::numeric_limits<double>::infinity()})
            for (const float pressure : through({thickness, poisson}, pressed_cell(14, 25, 1000))) {
                CHECK(pressure >= 0);
                CHECK(pressure < 1e-6f);
            }
        // One as thick as the array is wide lets a part of the force through.
        const double felt = sum(through({0.05, poisson}, pressed_cell(14, 25, 1000)));
        CHECK(felt > 100);
        CHECK(felt < 900);
    }
}

TEST_CASE("pad: extreme pressures stay finite") {
    map extreme;
    for (float& pressure : extreme)
        pressure = std::numeric_limits<float>::max();
    extreme(3, 3) = INFINITY, extreme(4, 4) = NAN;
    for (const double thickness : {1e-5, 1e-3, 0.1})
        for (const float pressure : through({.thickness = thickness}, extreme)) {
            CHECK(pressure >= 0); // and so no NaN
            CHECK(pressure <= std::numeric_limits<float>::infinity());
        }
}

constexpr tactnet::shape cells{4, 6};

TEST_CASE("tactel_average: each tactel is the mean of its own square of cells") {
    tactnet::tensor<float, cells> from;
    for (std::size_t row = 0; row < cells.rows; ++row)
        for (std::size_t column = 0; column < cells.columns; ++column)
            from(row, column) = static_cast<float>(10 * row + column);
    using bound = tactel_average<2>::bound<cells>;
    static_assert(bound::tactels == tactnet::shape{2, 3});
    tactnet::tensor<float, bound::tactels> means;
    bound({}, {}).apply(from, means.view(), {});
    for (std::size_t row = 0; row < 2; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            CHECK(means(row, column) == static_cast<float>(20 * row + 2 * column) + 5.5f);
}

TEST_CASE("tactel_average: one cell a tactel changes no bit") {
    tactnet::tensor<float, cells> from, means;
    for (std::size_t i = 0; i < cells.size(); ++i)
        from.data()[i] = static_cast<float>(i) * 0.37f;
    tactel_average<1>::bound<cells>({}, {}).apply(from, means.view(), {});
    CHECK(std::ranges::equal(from, means));
}

} // namespace
