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
#include <vector>

namespace {

using namespace tactnet::simulation;
using support::heights_of, support::press, support::peak_of, support::sum_of;
using tactnet::shape;

std::size_t cells(int count) {
    return static_cast<std::size_t>(std::abs(count));
}

TEST_CASE("bonded_layer: all cells pressed alike sink as a layer does that cannot widen") {
    // k = 0: h (1 + ν) (1 − 2ν) / ((1 − ν) E), whatever the ratio of thickness and cell.
    for (const double poisson : {-0.5, 0.0, 0.3, 0.45, 0.49})
        for (const double thickness : {0.01, 0.1, 0.37, 1.0, 2.5}) { // in cells
            CAPTURE(poisson);
            CAPTURE(thickness);
            const layer_influence influence(thickness * 2e-3, poisson, 2e-3);
            double sum = 0;
            for (int y = -100; y <= 100; ++y)
                for (int x = -100; x <= 100; ++x)
                    sum += influence(cells(y), cells(x));
            const double expected =
                thickness * 2e-3 * (1 - 2 * poisson) / ((1 - poisson) * (1 - poisson)); // E / (1 − ν²) = 1
            CHECK(sum == doctest::Approx(expected).epsilon(1e-4).scale(0));
        }
}

TEST_CASE("bonded_layer: however thin and incompressible, pressing never raises what is pressed") {
    using convolution = tactnet::kernels::symmetric_convolution<shape{28, 50}>;
    convolution convolver;
    for (const double poisson : {0.4999, 0.4999999, 0.5})
        for (double thickness = 1e-3; thickness < 5; thickness *= 1.1) { // in cells
            CAPTURE(poisson);
            CAPTURE(thickness);
            const layer_influence influence(thickness, poisson, 1);
            CHECK(influence(0, 0) > 0);
            for (const double share : convolver.spectrum_of(influence))
                CHECK(share > 0);
        }
}

TEST_CASE("bonded_layer: a periodic load sinks by the compliance of its wavelength") {
    // Pressure cos(k x) even over each cell: Σ over the waves k + 2πn that have the same values in the middle
    // of the cells, each with its share sinc and its own compliance.
    for (const double poisson : {0.0, 0.3, 0.5})
        for (const double thickness : {0.1, 0.5, 2.0}) {
            CAPTURE(poisson);
            CAPTURE(thickness);
            const layer_influence influence(thickness, poisson, 1);
            const double k = 0.9;
            double wave = 0;
            for (int y = -75; y <= 75; ++y)
                for (int x = -75; x <= 75; ++x)
                    wave += influence(cells(y), cells(x)) * std::cos(k * x);
            double expected = 0;
            for (int n = -20000; n <= 20000; ++n) {
                const double q = k + 2 * std::numbers::pi * n;
                expected += std::sin(q / 2) / (q / 2) * 2 / std::abs(q) *
                            layer_compliance(std::abs(q) * thickness, poisson);
            }
            // The influence is a difference of two numbers as large as the thickness, of which a thin
            // incompressible layer leaves a hundredth: what its tables err by, 1e-6 of the thickness, stays.
            CHECK(wave == doctest::Approx(expected).epsilon(1e-4).scale(1e-2 * thickness));
        }
}

TEST_CASE("bonded_layer: a thick one is a half space") {
    const double cell = 1e-3;
    for (const double poisson : {0.0, 0.3, 0.5}) {
        const layer_influence endless(std::numeric_limits<double>::infinity(), poisson, cell),
            thick(1e3 * cell, poisson, cell);
        for (std::size_t x = 0; x < 50; x += 7) {
            CHECK(endless(3, x) == doctest::Approx(half_space_influence(3, x, cell)).epsilon(1e-14).scale(0));
            // What the base holds back is the same everywhere, between one and 1.8 over the thickness.
            CHECK(half_space_influence(3, x, cell) - thick(3, x) > 0);
            CHECK(half_space_influence(3, x, cell) - thick(3, x) < 1.8e-3 * cell / std::numbers::pi);
        }
    }
    constexpr shape size{64, 64};
    const auto heights = heights_of<size>(1e-4, support::sphere(0.02));
    const auto half =
        press(elastic_half_space{.young = 1e6, .poisson = 0.4}, 1e-4, heights, pressing::to_force(1));
    const auto layer = press(bonded_layer{.young = 1e6, .poisson = 0.4, .thickness = 1}, 1e-4, heights,
                             pressing::to_force(1));
    CHECK(layer.report.depth == doctest::Approx(half.report.depth).epsilon(5e-3).scale(0));
    CHECK(peak_of(layer.pressures) == doctest::Approx(peak_of(half.pressures)).epsilon(1e-3));
}

TEST_CASE("bonded_layer: a thin one that can be squeezed is a bed of springs") {
    constexpr shape size{48, 48};
    const double cell = 1e-3, young = 1e5, poisson = 0.3, thickness = 1e-4;
    const double squeezed = (1 - poisson) * young / ((1 + poisson) * (1 - 2 * poisson));
    const auto heights = heights_of<size>(cell, support::sphere(0.5));
    for (const double force : {0.1, 1.0, 10.0}) {
        const auto layer = press(bonded_layer{.young = young, .poisson = poisson, .thickness = thickness},
                                 cell, heights, pressing::to_force(force));
        const auto springs = press(winkler{.modulus = squeezed, .thickness = thickness}, cell, heights,
                                   pressing::to_force(force));
        CHECK(layer.report.depth == doctest::Approx(springs.report.depth).epsilon(1e-3).scale(0));
        for (std::size_t i = 0; i < size.size(); ++i)
            CHECK(std::abs(layer.pressures.data()[i] - springs.pressures.data()[i]) <=
                  2e-3 * peak_of(springs.pressures));
    }
}

TEST_CASE(
    "bonded_layer: an incompressible one is stiffer than one that can be squeezed, the thinner the more") {
    constexpr shape size{32, 32};
    const auto heights = heights_of<size>(1e-3, support::sphere(0.05));
    const auto depth = [&](double poisson, double thickness) {
        // The same E / (1 − ν²).
        return press(bonded_layer{.young = 1e5 * (1 - poisson * poisson),
                                  .poisson = poisson,
                                  .thickness = thickness},
                     1e-3, heights, pressing::to_force(5))
            .report.depth;
    };
    double before = 0;
    for (const double thickness : {1e-3, 2e-3, 5e-3, 2e-2, 1e-1}) {
        const double ratio = depth(0.5, thickness) / depth(0.3, thickness);
        CAPTURE(thickness);
        CHECK(ratio < 1);
        CHECK(ratio > before);
        before = ratio;
    }
    CHECK(depth(0.4999999, 2e-3) == doctest::Approx(depth(0.5, 2e-3)).epsilon(1e-5).scale(0));
}

/// Mean square distance of the pressure from the axis, in metres, on a grid of `Cells` × `Cells`.
template <std::size_t Cells>
double spread_on() {
    constexpr double cell = 0.024 / static_cast<double>(Cells);
    constexpr shape size{Cells, Cells};
    const auto found = press(bonded_layer{.young = 1e5, .poisson = 0.45, .thickness = 3e-3}, cell,
                             heights_of<size>(cell, support::sphere(0.02)), pressing::to_force(2));
    const auto squares = heights_of<size>(cell, [](double y, double x) { return x * x + y * y; });
    double sum = 0;
    for (std::size_t i = 0; i < size.size(); ++i)
        sum += static_cast<double>(found.pressures.data()[i]) * static_cast<double>(squares.data()[i]);
    return std::sqrt(sum * cell * cell / 2);
}

TEST_CASE("bonded_layer: a finer grid changes less and less") {
    const double coarse = spread_on<8>(), middle = spread_on<24>(), fine = spread_on<72>(),
                 finest = spread_on<144>();
    CHECK(std::abs(middle - finest) < std::abs(coarse - finest) / 2);
    CHECK(std::abs(fine - finest) < std::abs(middle - finest) / 2);
    CHECK(std::abs(fine - finest) < 1e-3 * finest);
}

constexpr shape array_size{28, 50};
constexpr double tactel = 1.903e-3;

/// The softer the sensor, the more cells touch, the lower the peak, and the deeper the object.
void check_order(const tactnet::tensor<float, array_size>& heights, double force) {
    CAPTURE(force);
    std::size_t cells = 0;
    double peak = std::numeric_limits<double>::infinity(), depth = 0;
    for (const bonded_layer& sensor : {rigid_sensor, semi_rigid_sensor, flexible_sensor}) {
        const auto found = press(sensor, tactel, heights, pressing::to_force(force));
        CHECK(found.report.converged);
        CHECK(found.report.cells > cells);
        CHECK(peak_of(found.pressures) < 0.8 * peak);
        CHECK(found.report.depth > 1.5 * depth);
        cells = found.report.cells, peak = peak_of(found.pressures), depth = found.report.depth;
    }
}

TEST_CASE("bonded_layer: rigid, semi-rigid, flexible: contact grows and the dynamic range falls") {
    for (const double force : {5.0, 10.0, 30.0}) {
        check_order(heights_of<array_size>(tactel, support::sphere(0.03)), force);
        // A bar across the array, round to 10 mm and rounded off at its ends.
        check_order(heights_of<array_size>(tactel,
                                           [](double y, double x) {
                                               const double beyond = std::max(std::abs(y) - 0.015, 0.0);
                                               return x * x / 0.02 + beyond * beyond / 0.004;
                                           }),
                    force);
        // A box with rounded edges, its side crowned by two tenths of a millimetre as real ones are.
        check_order(heights_of<array_size>(tactel,
                                           [](double y, double x) {
                                               const double beyond =
                                                   std::hypot(std::max(std::abs(y) - 0.008, 0.0),
                                                              std::max(std::abs(x) - 0.012, 0.0));
                                               return beyond * beyond / 0.02 + x * x + y * y;
                                           }),
                    force);
    }
}

} // namespace
