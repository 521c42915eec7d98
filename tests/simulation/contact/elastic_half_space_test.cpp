#include "pressed.hpp"

#include <tactnet/simulation/contact/elastic_half_space.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace {

using namespace tactnet::simulation;
using support::heights_of, support::press, support::peak_of, support::sum_of;
using tactnet::shape;
using tactnet::tensor;

constexpr elastic_half_space rubber{.young = 1e6, .poisson = 0.3};
constexpr double modulus = 1e6 / (1 - 0.3 * 0.3); // E* in pascals

/// Sphere of radius R under F (Hertz; Johnson, Contact Mechanics, 1985, section 4.2).
struct hertz_sphere {
    double radius, force, star = modulus;
    double contact() const { return std::cbrt(3 * force * radius / (4 * star)); }
    double peak() const { return 3 * force / (2 * std::numbers::pi * contact() * contact()); }
    double depth() const { return contact() * contact() / radius; }
};

TEST_CASE("elastic_half_space: Love's integral is that of one over the distance") {
    // Far away by a fine sum over points; over the cell itself 4 ln(1 + √2).
    CHECK(love_integral(0, 0) == doctest::Approx(4 * std::log(1 + std::sqrt(2))).epsilon(1e-14));
    for (const std::array<double, 2> place : {std::array{1.0, 0.0}, {1.0, 1.0}, {7.0, 3.0}, {49.0, 27.0}}) {
        double sum = 0;
        constexpr int points = 400;
        for (int i = 0; i < points; ++i)
            for (int j = 0; j < points; ++j)
                sum +=
                    1 / std::hypot(place[0] + (i + 0.5) / points - 0.5, place[1] + (j + 0.5) / points - 0.5);
        CHECK(love_integral(place[0], place[1]) == doctest::Approx(sum / points / points).epsilon(1e-5));
        CHECK(love_integral(place[0], place[1]) ==
              doctest::Approx(love_integral(place[1], place[0])).epsilon(1e-12));
    }
}

TEST_CASE("elastic_half_space: a sphere: radius, peak, depth and profile of Hertz within 2 %") {
    const hertz_sphere hertz{.radius = 0.02, .force = 1};
    constexpr shape size{80, 80};
    const double cell = 2.4 * hertz.contact() / 80;
    const auto found =
        press(rubber, cell, heights_of<size>(cell, support::sphere(hertz.radius)), pressing::to_force(1));
    REQUIRE(found.report.converged);
    CHECK(found.report.force == doctest::Approx(1).epsilon(1e-9));
    CHECK(sum_of(found.pressures) * cell * cell == doctest::Approx(1).epsilon(1e-6));
    CHECK(found.report.depth == doctest::Approx(hertz.depth()).epsilon(0.005).scale(0));
    CHECK(peak_of(found.pressures) == doctest::Approx(hertz.peak()).epsilon(0.02));
    const double radius = std::sqrt(static_cast<double>(found.report.cells) * cell * cell / std::numbers::pi);
    CHECK(radius == doctest::Approx(hertz.contact()).epsilon(0.02).scale(0));
    for (std::size_t row = 0; row < size.rows; ++row)
        for (std::size_t column = 0; column < size.columns; ++column) {
            const double r = std::hypot(static_cast<double>(row) - 39.5, static_cast<double>(column) - 39.5) *
                             cell / hertz.contact();
            const double expected = r < 1 ? hertz.peak() * std::sqrt(1 - r * r) : 0;
            // At the rim the profile ends upright, and a cell is partly in contact.
            const double tolerance = r > 0.93 && r < 1.07 ? 0.2 : 0.02;
            CHECK(std::abs(static_cast<double>(found.pressures(row, column)) - expected) <
                  tolerance * hertz.peak());
        }
}

TEST_CASE("elastic_half_space: pressed to a depth it bears the force that belongs to it") {
    const hertz_sphere hertz{.radius = 0.02, .force = 2};
    constexpr shape size{64, 64};
    const double cell = 2.4 * hertz.contact() / 64;
    const auto heights = heights_of<size>(cell, support::sphere(hertz.radius));
    const auto found = press(rubber, cell, heights, pressing::to_depth(hertz.depth()));
    CHECK(found.report.converged);
    // The lowest cells are half a diagonal off the axis, as high as a part of the cell.
    CHECK(found.report.depth == doctest::Approx(hertz.depth()).epsilon(1e-9).scale(0));
    CHECK(found.report.force == doctest::Approx(hertz.force).epsilon(0.01));
    // Back by force to the same depth.
    const auto again = press(rubber, cell, heights, pressing::to_force(found.report.force));
    CHECK(again.report.depth == doctest::Approx(found.report.depth).epsilon(1e-4).scale(0));
}

TEST_CASE("elastic_half_space: a deformable object yields as much as the surface does") {
    hertz_sphere hertz{.radius = 0.02, .force = 1, .star = modulus / 3};
    constexpr shape size{64, 64};
    const double cell = 2.4 * hertz.contact() / 64;
    pressing how = pressing::to_force(1);
    how.object_modulus = modulus / 2; // 1 / E* = 1 / modulus + 2 / modulus
    const auto found = press(rubber, cell, heights_of<size>(cell, support::sphere(hertz.radius)), how);
    CHECK(found.report.depth == doctest::Approx(hertz.depth()).epsilon(0.005).scale(0));
    CHECK(peak_of(found.pressures) == doctest::Approx(hertz.peak()).epsilon(0.02));
}

TEST_CASE("elastic_half_space: a long cylinder: in the middle the line contact of Hertz within 2 %") {
    // Half width b = √(4 P R / (π E*)) under P newtons a metre, peak 2P / (π b) (Johnson, section 4.2c).
    const double radius = 0.01, line_load = 200;
    const double half_width = std::sqrt(4 * line_load * radius / (std::numbers::pi * modulus)),
                 peak = 2 * line_load / (std::numbers::pi * half_width);
    constexpr shape size{512, 48};
    const double cell = 2.4 * half_width / 48, length = 512 * cell;
    const auto found = press(rubber, cell, heights_of<size>(cell, support::cylinder(radius)),
                             pressing::to_force(line_load * length));
    CHECK(found.report.converged);
    const std::size_t middle = size.rows / 2;
    // Towards its ends it bears more, as the surface there is free on one side: the load that counts is the
    // one in the middle.
    double load = 0, moment = 0;
    for (std::size_t column = 0; column < size.columns; ++column) {
        const double x = (static_cast<double>(column) - 23.5) * cell,
                     pressure = static_cast<double>(found.pressures(middle, column));
        load += pressure * cell;
        moment += pressure * cell * x * x;
    }
    CHECK(load == doctest::Approx(line_load).epsilon(0.2));
    const double scale = std::sqrt(load / line_load); // half width and peak go with the root of the load
    // The mean square of a half ellipse is b² / 4.
    CHECK(2 * std::sqrt(moment / load) == doctest::Approx(half_width * scale).epsilon(0.02).scale(0));
    for (std::size_t column = 0; column < size.columns; ++column) {
        const double x = (static_cast<double>(column) - 23.5) * cell / (half_width * scale);
        if (std::abs(x) < 0.93)
            CHECK(static_cast<double>(found.pressures(middle, column)) ==
                  doctest::Approx(peak * scale * std::sqrt(1 - x * x)).epsilon(0.02));
    }
}

TEST_CASE("elastic_half_space: a flat punch: pressure away from the rim, and depth") {
    // p = F / (2π a √(a² − r²)), depth F / (2 a E*) (Johnson, section 3.4).
    const double radius = 5e-3, force = 10;
    constexpr shape size{84, 84};
    const double cell = 2 * radius / 80;
    const auto found =
        press(rubber, cell, heights_of<size>(cell, support::round_punch(radius)), pressing::to_force(force));
    CHECK(found.report.converged);
    CHECK(found.report.depth == doctest::Approx(force / (2 * radius * modulus)).epsilon(0.01).scale(0));
    for (std::size_t row = 0; row < size.rows; ++row)
        for (std::size_t column = 0; column < size.columns; ++column) {
            const double r =
                std::hypot(static_cast<double>(row) - 41.5, static_cast<double>(column) - 41.5) * cell;
            if (r < 0.8 * radius)
                CHECK(static_cast<double>(found.pressures(row, column)) ==
                      doctest::Approx(force /
                                      (2 * std::numbers::pi * radius * std::sqrt(radius * radius - r * r)))
                          .epsilon(0.02));
        }
}

/// Error of the depth under a sphere on `Cells` × `Cells`.
template <std::size_t Cells>
double depth_error() {
    const hertz_sphere hertz{.radius = 0.02, .force = 1};
    constexpr shape size{Cells, Cells};
    const double cell = 2.5 * hertz.contact() / static_cast<double>(Cells);
    const auto found =
        press(rubber, cell, heights_of<size>(cell, support::sphere(hertz.radius)), pressing::to_force(1));
    // Depth is counted from the lowest cell, half a diagonal off the axis.
    const double lowest = 2 * (cell / 2) * (cell / 2) / (2 * hertz.radius);
    return std::abs(found.report.depth + lowest - hertz.depth()) / hertz.depth();
}

TEST_CASE("elastic_half_space: a finer grid is closer to the truth") {
    const double coarse = depth_error<8>(), middle = depth_error<24>(), fine = depth_error<72>();
    CHECK(middle < coarse / 2);
    CHECK(fine < middle / 2);
    CHECK(fine < 1e-3);
}

} // namespace
