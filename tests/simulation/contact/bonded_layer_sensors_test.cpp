#include "pressed.hpp"

#include <tactnet/simulation/contact/bonded_layer.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace {

using namespace tactnet::simulation;
using support::heights_of, support::press, support::peak_of;
using tactnet::shape;
using tactnet::tensor;

constexpr shape size{28, 50};
constexpr double cell = 1.903e-3;

/// The softer the sensor, the more cells touch, the lower the peak, and the deeper the object.
void check_order(const tensor<float, size>& heights, double force) {
    CAPTURE(force);
    std::size_t cells = 0;
    double peak = std::numeric_limits<double>::infinity(), depth = 0;
    for (const bonded_layer& sensor : {rigid_sensor, semi_rigid_sensor, flexible_sensor}) {
        const auto found = press(sensor, cell, heights, pressing::to_force(force));
        CHECK(found.report.converged);
        CHECK(found.report.cells > cells);
        CHECK(peak_of(found.pressures) < 0.8 * peak);
        CHECK(found.report.depth > 1.5 * depth);
        cells = found.report.cells, peak = peak_of(found.pressures), depth = found.report.depth;
    }
}

TEST_CASE("bonded_layer: rigid, semi-rigid, flexible: contact grows and the dynamic range falls") {
    for (const double force : {5.0, 10.0, 30.0}) {
        check_order(heights_of<size>(cell, support::sphere(0.03)), force);
        // A bar across the array, round to 10 mm and rounded off at its ends.
        check_order(heights_of<size>(cell,
                                     [](double y, double x) {
                                         const double beyond = std::max(std::abs(y) - 0.015, 0.0);
                                         return x * x / 0.02 + beyond * beyond / 0.004;
                                     }),
                    force);
        // A box with rounded edges, its side crowned by two tenths of a millimetre as real ones are.
        check_order(heights_of<size>(cell,
                                     [](double y, double x) {
                                         const double beyond = std::hypot(std::max(std::abs(y) - 0.008, 0.0),
                                                                          std::max(std::abs(x) - 0.012, 0.0));
                                         return beyond * beyond / 0.02 + x * x + y * y;
                                     }),
                    force);
    }
}

} // namespace
