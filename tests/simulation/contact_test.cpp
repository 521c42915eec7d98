#include "pressed.hpp"

#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/simulation/contact/elastic.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <support/guarded_map.hpp>
#include <vector>

namespace {

using namespace tactnet::simulation;
using support::heights_of, support::peak_of, support::press, support::sum_of;
using tactnet::shape;
using tactnet::tensor;

constexpr shape few_tactels{13, 17}; // no whole number of lanes
constexpr double pitch = 1.9e-3;
using few = tensor<float, few_tactels>;
constexpr float infinite = std::numeric_limits<float>::infinity();
constexpr float broken = std::numeric_limits<float>::quiet_NaN();
constexpr winkler foam{.modulus = 1.35e5, .thickness = 3e-3};

/// The depth at which springs sorted by height bear a force, one joining after the other.
long double sorted_depth(const few& heights, double stiffness, double force) {
    std::vector<long double> sorted;
    for (const float height : heights)
        if (std::isfinite(height))
            sorted.push_back(static_cast<long double>(height));
    std::sort(sorted.begin(), sorted.end());
    const long double lowest = sorted.front();
    const long double depths = static_cast<long double>(force) / (stiffness * pitch * pitch);
    long double sum = 0;
    for (std::size_t count = 1; count <= sorted.size(); ++count) {
        sum += sorted[count - 1] - lowest;
        const long double depth = (depths + sum) / count;
        if (count == sorted.size() || depth <= sorted[count] - lowest)
            return depth;
    }
    return 0;
}

TEST_CASE("winkler: the force and the depth of a reference that sorts them") {
    std::uint64_t state = 7;
    for (int round = 0; round < 20; ++round) {
        few heights;
        for (float& height : heights)
            height = support::draw(state) * 1e-3f + (round % 2 == 0 ? 0.0f : 0.5f);
        if (round % 3 == 0)
            heights(3, 3) = infinite, heights(4, 4) = broken, heights(5, 5) = -infinite;
        for (const double force : {1e-12, 1e-6, 0.01, 1.0, 30.0, 1e9}) {
            pressing how = pressing::to_force(force);
            if (round % 4 == 0)
                how.object_modulus = 2e5;
            const double stiffness =
                1 / (foam.thickness / foam.modulus + how.object_thickness / how.object_modulus);
            const auto found = press(foam, pitch, heights, how);
            CHECK(found.report.converged);
            CHECK(found.report.force == doctest::Approx(force).epsilon(1e-9).scale(0));
            CHECK(sum_of(found.pressures) * pitch * pitch == doctest::Approx(force).epsilon(1e-6).scale(0));
            const long double depth = sorted_depth(heights, stiffness, force);
            // Sums of 221 in double. Heights of 0.5 m take no digits from a depth of 1e-14 m.
            CHECK(std::abs(static_cast<long double>(found.report.depth) - depth) <= 1e-12L * depth);
            float lowest = infinite;
            for (const float height : heights)
                lowest = std::isfinite(height) ? std::min(lowest, height) : lowest;
            std::size_t cells = 0;
            for (std::size_t i = 0; i < few_tactels.size(); ++i) {
                const float height = heights.data()[i];
                const long double sunk =
                    std::isfinite(height)
                        ? depth - (static_cast<long double>(height) - static_cast<long double>(lowest))
                        : 0;
                const double expected = sunk > 0 ? stiffness * static_cast<double>(sunk) : 0;
                CHECK(static_cast<double>(found.pressures.data()[i]) ==
                      doctest::Approx(expected).epsilon(1e-7).scale(stiffness * 1e-8));
                cells += found.pressures.data()[i] > 0;
            }
            CHECK(found.report.cells == cells);
            CHECK(found.report.iterations <= few_tactels.size());
        }
    }
}

TEST_CASE("winkler: springs pressed to a depth") {
    const few heights = heights_of<few_tactels>(pitch, support::sphere(0.02));
    const auto found = press(foam, pitch, heights, pressing::to_depth(5e-4));
    CHECK(found.report.depth == doctest::Approx(5e-4).epsilon(1e-12).scale(0));
    CHECK(static_cast<double>(found.pressures(6, 8)) == doctest::Approx(5e-4 * 1.35e5 / 3e-3).epsilon(1e-6));
    const auto back = press(foam, pitch, heights, pressing::to_force(found.report.force));
    CHECK(back.report.depth == doctest::Approx(5e-4).epsilon(1e-9).scale(0));
}

void check_nothing(const few& heights, const pressing& how, bool converged) {
    const auto found = press(foam, pitch, heights, how);
    CHECK(found.report.converged == converged);
    CHECK(found.report.force == 0);
    CHECK(found.report.depth == 0);
    CHECK(found.report.cells == 0);
    for (const float pressure : found.pressures)
        CHECK(pressure == 0);
}

TEST_CASE("winkler: nothing to press, or nothing that presses") {
    const few ball = heights_of<few_tactels>(pitch, support::sphere(0.02));
    for (const float none : {infinite, -infinite, broken}) {
        few nowhere;
        std::ranges::fill(nowhere, none);
        check_nothing(nowhere, pressing::to_force(1), false);
        check_nothing(nowhere, pressing::to_depth(1e-3), false);
        check_nothing(nowhere, pressing::to_force(0), true);
    }
    for (const double amount : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        check_nothing(ball, pressing::to_force(amount), true);
        check_nothing(ball, pressing::to_depth(amount), true);
    }
    check_nothing(ball, pressing::to_force(std::numeric_limits<double>::infinity()), false);
    check_nothing(ball, pressing::to_depth(std::numeric_limits<double>::infinity()), false);
}

TEST_CASE("winkler: an impossible modulus makes a rigid object") {
    const few ball = heights_of<few_tactels>(pitch, support::sphere(0.02));
    const double depth = press(foam, pitch, ball, pressing::to_force(5)).report.depth;
    for (const double object : {0.0, -1e5, 1e-30, std::numeric_limits<double>::quiet_NaN()})
        CHECK(press(foam, pitch, ball, {pressing::goal::force, 5, object}).report.depth == depth);
    CHECK(press(foam, pitch, ball, {pressing::goal::force, 5, 1e5}).report.depth > depth);
}

TEST_CASE("winkler: one cell, and all of them") {
    few needle;
    std::ranges::fill(needle, infinite);
    needle(12, 16) = -0.3f;
    const auto one = press(foam, pitch, needle, pressing::to_force(2));
    CHECK(one.report.cells == 1);
    CHECK(static_cast<double>(one.pressures(12, 16)) * pitch * pitch == doctest::Approx(2).epsilon(1e-6));
    const auto all = press(foam, pitch, few{}, pressing::to_force(2));
    CHECK(all.report.cells == few_tactels.size());
    for (const float pressure : all.pressures)
        CHECK(pressure == all.pressures(0, 0));
}

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
