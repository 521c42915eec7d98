#include <tactnet/simulation/elasticity/radial_kernel.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

namespace {

using namespace tactnet::simulation;

TEST_CASE("radial_kernel: Bessel's function is the integral that defines it") {
    for (double z = 0; z < 1500; z = z * 1.07 + 0.1) {
        // The mean of cos(z sin θ) over even steps, exact to the last digits once they are close enough.
        const int steps = 40 + static_cast<int>(z);
        double sum = 0;
        for (int i = 0; i < steps; ++i)
            sum += std::cos(z * std::sin(std::numbers::pi * (i + 0.5) / steps));
        CAPTURE(z);
        CHECK(std::abs(bessel_zero(z) - sum / steps) < 1e-11);
    }
}

TEST_CASE("radial_kernel: a table of known transforms") {
    // ∫ e⁻²ˣ J₀(xs) dx = 1 / √(s² + 4), and ∫ x e⁻ˣ J₀(xs) dx = (s² + 1)^(−3/2).
    const radial_kernel distance([](double x) { return std::exp(-2 * x); }, 16);
    const radial_kernel shadow([](double x) { return x * std::exp(-x); }, 36);
    for (double s = 0; s < 33; s += 0.037) {
        CAPTURE(s);
        CHECK(std::abs(distance(s) - 1 / std::hypot(s, 2.0)) < 2e-8);
        CHECK(std::abs(shadow(s) - std::pow(s * s + 1, -1.5)) < 2e-7);
    }
    CHECK(distance(1e9) == doctest::Approx(1e-9).epsilon(1e-12));
    CHECK(shadow(1e9) == 0);
}

TEST_CASE("radial_kernel: integrals over rectangles, near a narrow peak and far from it") {
    const auto near_distance = [](double depth) {
        return [=](double x, double y) { return depth / std::pow(x * x + y * y + depth * depth, 1.5); };
    };
    // The solid angle of a quarter plane's rectangle: atan(xy / (depth · distance)).
    const auto angle = [](double x, double y, double depth) {
        return std::atan(x * y / (depth * std::hypot(x, y, depth)));
    };
    for (const double depth : {1e-6, 1e-3, 0.1, 1.0, 50.0}) {
        CAPTURE(depth);
        CHECK(
            integrate({-1, 2, -3, 1}, depth, near_distance(depth)) ==
            doctest::Approx(angle(1, 3, depth) + angle(2, 3, depth) + angle(1, 1, depth) + angle(2, 1, depth))
                .epsilon(1e-4));
        CHECK(
            integrate({4, 5, 7, 8}, depth, near_distance(depth)) ==
            doctest::Approx(angle(5, 8, depth) - angle(4, 8, depth) - angle(5, 7, depth) + angle(4, 7, depth))
                .epsilon(1e-6));
    }
}

} // namespace
