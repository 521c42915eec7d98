#include "pressed.hpp"

#include <tactnet/simulation/contact/winkler.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <support/guarded_map.hpp>
#include <vector>

namespace {

using namespace tactnet::simulation;
using support::heights_of, support::press, support::sum_of;
using tactnet::shape;
using tactnet::tensor;

constexpr shape size{13, 17}; // no whole number of lanes
constexpr double cell = 1.9e-3;
using map = tensor<float, size>;
constexpr float infinite = std::numeric_limits<float>::infinity();
constexpr float broken = std::numeric_limits<float>::quiet_NaN();
constexpr winkler foam{.modulus = 1.35e5, .thickness = 3e-3};

/// The depth at which springs sorted by height bear a force, one joining after the other.
long double sorted_depth(const map& heights, double stiffness, double force) {
    std::vector<long double> sorted;
    for (const float height : heights)
        if (std::isfinite(height))
            sorted.push_back(static_cast<long double>(height));
    std::sort(sorted.begin(), sorted.end());
    const long double lowest = sorted.front();
    const long double depths = static_cast<long double>(force) / (stiffness * cell * cell);
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
        map heights;
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
            const auto found = press(foam, cell, heights, how);
            CHECK(found.report.converged);
            CHECK(found.report.force == doctest::Approx(force).epsilon(1e-9).scale(0));
            CHECK(sum_of(found.pressures) * cell * cell == doctest::Approx(force).epsilon(1e-6).scale(0));
            const long double depth = sorted_depth(heights, stiffness, force);
            // Sums of 221 in double. Heights of 0.5 m take no digits from a depth of 1e-14 m.
            CHECK(std::abs(static_cast<long double>(found.report.depth) - depth) <= 1e-12L * depth);
            float lowest = infinite;
            for (const float height : heights)
                lowest = std::isfinite(height) ? std::min(lowest, height) : lowest;
            std::size_t cells = 0;
            for (std::size_t i = 0; i < size.size(); ++i) {
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
            CHECK(found.report.iterations <= size.size());
        }
    }
}

TEST_CASE("winkler: springs pressed to a depth") {
    const map heights = heights_of<size>(cell, support::sphere(0.02));
    const auto found = press(foam, cell, heights, pressing::to_depth(5e-4));
    CHECK(found.report.depth == doctest::Approx(5e-4).epsilon(1e-12).scale(0));
    CHECK(static_cast<double>(found.pressures(6, 8)) == doctest::Approx(5e-4 * 1.35e5 / 3e-3).epsilon(1e-6));
    const auto back = press(foam, cell, heights, pressing::to_force(found.report.force));
    CHECK(back.report.depth == doctest::Approx(5e-4).epsilon(1e-9).scale(0));
}

void check_nothing(const map& heights, const pressing& how, bool converged) {
    const auto found = press(foam, cell, heights, how);
    CHECK(found.report.converged == converged);
    CHECK(found.report.force == 0);
    CHECK(found.report.depth == 0);
    CHECK(found.report.cells == 0);
    for (const float pressure : found.pressures)
        CHECK(pressure == 0);
}

TEST_CASE("winkler: nothing to press, or nothing that presses") {
    const map ball = heights_of<size>(cell, support::sphere(0.02));
    for (const float none : {infinite, -infinite, broken}) {
        map nowhere;
        for (float& height : nowhere)
            height = none;
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
    const map ball = heights_of<size>(cell, support::sphere(0.02));
    const double depth = press(foam, cell, ball, pressing::to_force(5)).report.depth;
    for (const double object : {0.0, -1e5, 1e-30, std::numeric_limits<double>::quiet_NaN()})
        CHECK(press(foam, cell, ball, {pressing::goal::force, 5, object}).report.depth == depth);
    CHECK(press(foam, cell, ball, {pressing::goal::force, 5, 1e5}).report.depth > depth);
}

TEST_CASE("winkler: one cell, and all of them") {
    map needle;
    for (float& height : needle)
        height = infinite;
    needle(12, 16) = -0.3f;
    const auto one = press(foam, cell, needle, pressing::to_force(2));
    CHECK(one.report.cells == 1);
    CHECK(static_cast<double>(one.pressures(12, 16)) * cell * cell == doctest::Approx(2).epsilon(1e-6));
    const auto all = press(foam, cell, map{}, pressing::to_force(2));
    CHECK(all.report.cells == size.size());
    for (const float pressure : all.pressures)
        CHECK(pressure == all.pressures(0, 0));
}

} // namespace
