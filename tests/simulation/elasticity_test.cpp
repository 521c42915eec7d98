#include <tactnet/simulation/elasticity/layer_compliance.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

namespace {

using namespace tactnet::simulation;

using real = long double;

struct surface_and_base {
    real sinking, pressure;
};

/// One wave solved without the formulas: the displacements u sin kx and w cos kx of Papkovich and Neuber,
///
///     w = (a0 + a1 z) eᶻ + (b0 + b1 z) e⁻ᶻ,    u from Navier's equation,    k = 1, E / (1 − ν²) = 1,
///
/// whose four constants are found by elimination with pivots from u = w = 0 at the base z = 0 and σzz = −1,
/// σxz = 0 at the surface z = x.
surface_and_base solve_one_wave(real x, real nu) {
    const real shear = (1 - nu) / 2; // G for E* = 1
    const real kappa = 3 - 4 * nu;
    // Each of the four solutions: w, u, their derivatives at z. u = −w' − …: for (a0 + a1 z) eᶻ Navier gives
    // u = −(a0 + a1 z + κ a1) eᶻ, and for (b0 + b1 z) e⁻ᶻ u = (b0 + b1 z − κ b1) e⁻ᶻ.
    struct values {
        real u, w, du, dw;
    };
    const auto solution = [&](int which, real z) -> values {
        const real up = std::exp(z - x), down = std::exp(-z); // scaled to be no more than 1
        switch (which) {
        case 0:
            return {-up, up, -up, up};
        case 1:
            return {-(z + kappa) * up, z * up, -(z + kappa + 1) * up, (z + 1) * up};
        case 2:
            return {down, down, -down, -down};
        default:
            return {(z - kappa) * down, z * down, (1 - z + kappa) * down, (1 - z) * down};
        }
    };
    // σzz / 2G = ((1 − ν) w' + ν u) / (1 − 2ν), with x derivative of u sin kx = u cos kx; for ν = ½ the
    // dilatation w' + u over 1 − 2ν stays finite, and is ∓2 a1 eᶻ … for each solution.
    const auto dilatation_over = [&](int which, real z) -> real { // (w' + u) / (1 − 2ν)
        if (which == 1)
            return -2 * std::exp(z - x);
        if (which == 3)
            return -2 * std::exp(-z);
        return 0;
    };
    std::array<std::array<real, 5>, 4> system{};
    for (int i = 0; i < 4; ++i) {
        const auto column = static_cast<std::size_t>(i);
        const values base = solution(i, 0), top = solution(i, x);
        system[0][column] = base.u;
        system[1][column] = base.w;
        system[2][column] = 2 * shear * (top.dw + nu * dilatation_over(i, x)); // σzz
        system[3][column] = shear * (top.du - top.w);                          // σxz
    }
    system[2][4] = -1;
    for (std::size_t pivot = 0; pivot < 4; ++pivot) {
        std::size_t largest = pivot;
        for (std::size_t row = pivot; row < 4; ++row)
            if (std::abs(system[row][pivot]) > std::abs(system[largest][pivot]))
                largest = row;
        std::swap(system[pivot], system[largest]);
        for (std::size_t row = 0; row < 4; ++row)
            if (row != pivot) {
                const real factor = system[row][pivot] / system[pivot][pivot];
                for (std::size_t column = pivot; column < 5; ++column)
                    system[row][column] -= factor * system[pivot][column];
            }
    }
    surface_and_base result{0, 0};
    for (int i = 0; i < 4; ++i) {
        const auto row = static_cast<std::size_t>(i);
        const real amount = system[row][4] / system[row][row];
        result.sinking -= amount * solution(i, x).w;
        result.pressure -= amount * 2 * shear * (solution(i, 0).dw + nu * dilatation_over(i, 0));
    }
    return result;
}

TEST_CASE("layer_compliance: compliance and transfer of a layer are those of one wave solved directly") {
    for (const double poisson : {-0.5, 0.0, 0.2, 0.3, 0.45, 0.499, 0.5})
        for (double x = 0.05; x < 30; x *= 1.3) {
            CAPTURE(poisson);
            CAPTURE(x);
            const surface_and_base expected =
                solve_one_wave(static_cast<real>(x), static_cast<real>(poisson));
            // û = 2 / (E* k) M with E* = k = 1.
            CHECK(2 * layer_compliance(x, poisson) ==
                  doctest::Approx(static_cast<double>(expected.sinking)).epsilon(1e-12));
            CHECK(layer_transfer(x, poisson) ==
                  doctest::Approx(static_cast<double>(expected.pressure)).epsilon(1e-12));
            CHECK(layer_stiffening(x, poisson) + layer_compliance(x, poisson) ==
                  doctest::Approx(1).epsilon(1e-14));
        }
}

TEST_CASE("layer_compliance: thin, it is that of a bed of springs, an incompressible one is stiffer by far") {
    const double x = 1e-5;
    for (const double poisson : {-0.5, 0.0, 0.3, 0.49})
        CHECK(layer_compliance(x, poisson) ==
              doctest::Approx(x * (1 - 2 * poisson) / (2 * (1 - poisson) * (1 - poisson))).epsilon(1e-6));
    CHECK(layer_compliance(x, 0.5) == doctest::Approx(2 * x * x * x / 3).epsilon(1e-8).scale(1e-20));
    CHECK(layer_compliance(0, 0.5) == 0);
    CHECK(layer_compliance(0, 0.3) == 0);
    CHECK(layer_stiffening(0, 0.3) == 1);
    CHECK(layer_transfer(0, 0.5) == 1);
    CHECK(layer_transfer(0, 0.0) == 1);
}

TEST_CASE("layer_compliance: short waves see a half space, and nothing of them reaches the base") {
    for (const double poisson : {-0.9, 0.0, 0.3, 0.5})
        for (const double x :
             {40.0, 299.0, 300.0, 710.0, 1e4, 1e308, std::numeric_limits<double>::infinity()}) {
            CAPTURE(x);
            CHECK(layer_compliance(x, poisson) == doctest::Approx(1).epsilon(1e-15));
            CHECK(layer_stiffening(x, poisson) >= 0);
            CHECK(layer_stiffening(x, poisson) < 1e-30);
            CHECK(layer_transfer(x, poisson) >= 0);
            CHECK(layer_transfer(x, poisson) < 1e-15);
        }
    const double kappa = 3 - 4 * 0.3;
    CHECK(layer_stiffening(100, 0.3) / std::exp(-200.0) ==
          doctest::Approx((4e4 + 400 + kappa * kappa + 1) / kappa).epsilon(1e-12));
    CHECK(layer_transfer(100, 0.3) / std::exp(-100.0) ==
          doctest::Approx(2 * 1.4 / kappa * (100 + 1.4)).epsilon(1e-12));
}

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
