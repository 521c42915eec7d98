#include "pressed.hpp"

#include <tactnet/runtime/random.hpp>
#include <tactnet/simulation/contact/elastic.hpp>
#include <tactnet/simulation/objects/object.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <support/allocations.hpp>
#include <vector>

namespace {

using namespace tactnet::simulation;
using support::heights_of, support::press, support::peak_of, support::sum_of;
using tactnet::shape;
using tactnet::tensor;

constexpr shape size{28, 50};
constexpr double cell = 1.9e-3;
using map = tensor<float, size>;
constexpr float infinite = std::numeric_limits<float>::infinity();

/// What the solver of both models must never do, whatever it is given.
void check_sane(const support::pressed<size>& found, std::size_t max_iterations = 500) {
    CHECK(found.report.iterations <= max_iterations);
    CHECK(std::isfinite(found.report.force));
    CHECK(std::isfinite(found.report.depth));
    std::size_t cells = 0;
    for (const float pressure : found.pressures) {
        CHECK(pressure >= 0); // and no NaN
        CHECK(pressure < infinite);
        cells += pressure > 0;
    }
    CHECK(found.report.cells == cells);
    CHECK(sum_of(found.pressures) * cell * cell == doctest::Approx(found.report.force).epsilon(1e-6));
}
void check_nothing(const support::pressed<size>& found, bool converged) {
    check_sane(found);
    CHECK(found.report.converged == converged);
    CHECK(sum_of(found.pressures) == 0);
    CHECK(found.report.force == 0);
    CHECK(found.report.depth == 0);
}

/// Sinking of each cell, from the influence coefficients added up one by one; and what it would be if none of
/// them raised the surface, which shows how much rounding may do.
struct sunk_cell {
    double sinking = 0, magnitude = 0;
};
std::vector<sunk_cell> sinking(const bonded_layer& model, const map& pressures) {
    const layer_influence influence(model.thickness, model.poisson, cell);
    const double softness = (1 - model.poisson * model.poisson) / model.young;
    const auto apart = [](std::size_t a, std::size_t b) { return a > b ? a - b : b - a; };
    std::vector<double> coefficients(size.size());
    std::vector<sunk_cell> result(size.size());
    for (std::size_t y = 0; y < size.rows; ++y)
        for (std::size_t x = 0; x < size.columns; ++x)
            coefficients[y * size.columns + x] = softness * influence(y, x);
    for (std::size_t y = 0; y < size.rows; ++y)
        for (std::size_t x = 0; x < size.columns; ++x)
            for (std::size_t row = 0; pressures(y, x) > 0 && row < size.rows; ++row)
                for (std::size_t column = 0; column < size.columns; ++column) {
                    const double share = static_cast<double>(pressures(y, x)) *
                                         coefficients[apart(row, y) * size.columns + apart(column, x)];
                    result[row * size.columns + column].sinking += share;
                    result[row * size.columns + column].magnitude += std::abs(share);
                }
    return result;
}

/// No pressure pulls, nothing overlaps, and where there is a gap there is no pressure.
void check_complementary(const bonded_layer& model, const map& heights, const pressing& how) {
    const auto found = press(model, cell, heights, how);
    CHECK(found.report.converged);
    check_sane(found, model.accuracy.max_iterations);
    const std::vector<sunk_cell> sunk = sinking(model, found.pressures);
    double lowest = std::numeric_limits<double>::infinity();
    for (const float height : heights)
        lowest = std::min(lowest, static_cast<double>(height));
    for (std::size_t i = 0; i < size.size(); ++i) {
        // The accuracy of the solver, and pressures rounded to float.
        const double most =
            1.001 * model.accuracy.tolerance * found.report.depth + 0x1p-24 * sunk[i].magnitude;
        const double gap =
            static_cast<double>(heights.data()[i]) - lowest + sunk[i].sinking - found.report.depth;
        CHECK(gap >= -most);
        if (found.pressures.data()[i] > 0)
            CHECK(gap <= most);
    }
    if (how.until == pressing::goal::force)
        CHECK(sum_of(found.pressures) * cell * cell == doctest::Approx(how.amount).epsilon(1e-6));
    else
        CHECK(found.report.depth == how.amount);
}

/// Three feet of unlike height and shape on bumpy ground.
map bumpy() {
    return heights_of<size>(cell, [](double y, double x) {
        const double foot = std::min(
            {(x * x + y * y) / 0.02, 3e-4 + std::pow(x - 0.03, 2) / 0.01,
             std::hypot(x + 0.03, y - 0.01) < 0.008 ? 1e-4 : std::numeric_limits<double>::infinity()});
        return foot + 2e-5 * std::sin(3e3 * x) * std::cos(2e3 * y);
    });
}

TEST_CASE("polonsky_keer: pressures and gaps are none negative, and one of both is zero") {
    for (const double poisson : {0.0, 0.3, 0.5})
        for (const double thickness : {2e-4, 5e-4, 3e-3, 0.1}) { // from a tenth of a cell
            CAPTURE(poisson);
            CAPTURE(thickness);
            const bonded_layer layer{.young = 1e5, .poisson = poisson, .thickness = thickness};
            for (const double force : {0.05, 5.0, 500.0})
                check_complementary(layer, bumpy(), pressing::to_force(force));
            for (const double depth : {5e-5, 1e-3})
                check_complementary(layer, bumpy(), pressing::to_depth(depth));
            check_complementary(layer, map{}, pressing::to_force(20)); // all cells in contact
        }
}

TEST_CASE("polonsky_keer: contact does not depend on how high the object hangs, and it takes no heap") {
    map low = bumpy(), high = low;
    for (float& height : high)
        height += 0.25f; // exact in float only to 3e-8 m
    const bonded_layer layer{};
    CHECK(peak_of(press(layer, cell, low, pressing::to_force(5)).pressures) ==
          doctest::Approx(peak_of(press(layer, cell, high, pressing::to_force(5)).pressures)).epsilon(1e-3));

    bonded_layer::bound<size> bound(layer, cell);
    map pressures, again;
    const std::size_t before = support::allocations();
    bound.solve(low.view(), pressing::to_force(5), pressures.view());
    CHECK(support::allocations() == before);
    // Nothing is remembered of another touch: the same bits.
    bound.solve(high.view(), {pressing::goal::force, 900, 1e4}, again.view());
    bound.solve(low.view(), pressing::to_force(5), again.view());
    CHECK(std::equal(pressures.begin(), pressures.end(), again.begin()));
}

template <class Model>
void check_hard_cases(const Model& model) {
    const map ball = heights_of<size>(cell, support::sphere(0.02));
    const auto found = [&](const map& heights, const pressing& how) {
        return press(model, cell, heights, how);
    };
    // Nothing to press, or nothing that presses.
    map nowhere;
    for (const float none : {infinite, std::numeric_limits<float>::quiet_NaN(), -infinite}) {
        std::ranges::fill(nowhere, none);
        check_nothing(found(nowhere, pressing::to_force(1)), false);
        check_nothing(found(nowhere, pressing::to_depth(1)), false);
        check_nothing(found(nowhere, pressing::to_force(0)), true);
    }
    for (const double amount : {0.0, -3.0, std::numeric_limits<double>::quiet_NaN()}) {
        check_nothing(found(ball, pressing::to_force(amount)), true);
        check_nothing(found(ball, pressing::to_depth(amount)), true);
    }
    check_nothing(found(ball, pressing::to_force(std::numeric_limits<double>::infinity())), false);

    // Extremes: all of the array bears a giant, and one cell or few a speck of dust.
    const auto giant = found(ball, pressing::to_force(1e9));
    check_sane(giant);
    CHECK(giant.report.converged);
    CHECK(giant.report.cells == size.size());
    CHECK(giant.report.force == doctest::Approx(1e9).epsilon(1e-9));
    const auto dust = found(ball, pressing::to_force(1e-12));
    check_sane(dust);
    CHECK(dust.report.converged);
    CHECK(dust.report.cells <= 4);
    CHECK(dust.report.force == doctest::Approx(1e-12).epsilon(1e-9).scale(0));
    check_sane(found(ball, pressing::to_depth(1e3)));
    check_sane(found(ball, pressing::to_depth(1e-30)));

    map needle;
    std::ranges::fill(needle, infinite);
    needle(13, 20) = 0.001f;
    const auto one = found(needle, pressing::to_force(2));
    check_sane(one);
    CHECK(one.report.converged);
    CHECK(one.report.cells == 1);
    CHECK(static_cast<double>(one.pressures(13, 20)) * cell * cell == doctest::Approx(2).epsilon(1e-6));

    // An object larger than the array, flat and tilted; broken heights in it are no object.
    const map plate{};
    const auto whole = found(plate, pressing::to_force(50));
    check_sane(whole);
    CHECK(whole.report.converged);
    CHECK(whole.report.cells == size.size());
    map broken = heights_of<size>(cell, [](double y, double x) { return 0.01 * x + 0.002 * y; });
    broken(0, 0) = std::numeric_limits<float>::quiet_NaN(), broken(5, 5) = -infinite;
    const auto tilted = found(broken, pressing::to_force(50));
    check_sane(tilted);
    CHECK(tilted.report.converged);
    CHECK(tilted.pressures(0, 0) == 0);
    CHECK(tilted.pressures(5, 5) == 0);
    CHECK(tilted.report.cells > 50);

    // A soft object only makes it softer.
    double before = found(ball, pressing::to_force(5)).report.depth;
    for (const double object : {1e7, 1e5, 1e3}) {
        const auto soft = found(ball, {pressing::goal::force, 5, object});
        check_sane(soft);
        CHECK(soft.report.converged);
        CHECK(soft.report.depth > before);
        before = soft.report.depth;
    }
    // What is no modulus is that of a rigid object.
    for (const double object : {0.0, -1e5, 1e-30, std::numeric_limits<double>::quiet_NaN()})
        CHECK(found(ball, {pressing::goal::force, 5, object}).report.depth ==
              found(ball, pressing::to_force(5)).report.depth);
    // Beyond all reason: never a pressure where there is no object.
    map post = nowhere;
    post(3, 3) = 0;
    for (const pressing& how :
         {pressing{pressing::goal::force, 1e9, 1e-29}, pressing{pressing::goal::depth, 1e25},
          pressing{pressing::goal::depth, 1e30, 1e-29}}) {
        const auto extreme = found(post, how);
        check_sane(extreme);
        CHECK(extreme.report.cells == 1);
    }
}

TEST_CASE("polonsky_keer: hard cases on a half space and on layers of all kinds") {
    check_hard_cases(elastic_half_space{.young = 1e6, .poisson = 0.5});
    for (const double poisson : {-0.5, 0.0, 0.3, 0.49, 0.5 - 1e-9, 0.5})
        for (const double thickness : {1e-3, 3e-3, 0.05, std::numeric_limits<double>::infinity()}) {
            CAPTURE(poisson);
            CAPTURE(thickness);
            check_hard_cases(bonded_layer{.young = 1e5, .poisson = poisson, .thickness = thickness});
        }
}

TEST_CASE("polonsky_keer: random contacts are found in few steps") {
    tactnet::random_stream random(3, tactnet::random_purposes::touch);
    for (const bonded_layer& layer : {bonded_layer{}, bonded_layer{.poisson = 0.5, .thickness = 3e-3},
                                      bonded_layer{.poisson = 0.5, .thickness = 1}}) {
        bonded_layer::bound<size> bound(layer, cell);
        for (int round = 0; round < 100; ++round) {
            // A ridge or a ring of any direction, tilt, width and roughness.
            const double angle = random.uniform(0, 3), half_width = random.uniform(1e-3, 0.02),
                         radius = random.uniform(2e-3, 0.1), tilt = random.uniform(-0.02, 0.02),
                         roughness = random.uniform(0, 2e-4);
            const map heights = heights_of<size>(cell, [&](double y, double x) {
                const double along = std::cos(angle) * x + std::sin(angle) * y,
                             across = std::cos(angle) * y - std::sin(angle) * x;
                const double beyond = round % 2 == 0 ? std::max(std::abs(across) - half_width, 0.0)
                                                     : std::hypot(along, across) - half_width;
                return beyond * beyond / (2 * radius) + tilt * along + random.uniform(0, roughness);
            });
            const pressing how = round % 3 == 0 ? pressing::to_depth(random.uniform(1e-5, 2e-3))
                                                : pressing::to_force(std::exp(random.uniform(-3, 5)));
            support::pressed<size> found;
            found.report = bound.solve(heights.view(), how, found.pressures.view());
            CHECK(found.report.converged);
            check_sane(found, 60);
        }
    }
}

TEST_CASE("polonsky_keer: what cannot be found in time is said to be") {
    const auto found = press(bonded_layer{.accuracy = {.tolerance = 1e-9, .max_iterations = 2}}, cell,
                             bumpy(), pressing::to_force(50));
    CHECK(found.report.iterations == 2);
    CHECK(!found.report.converged);
    CHECK(found.report.force == doctest::Approx(50).epsilon(1e-9));
    // An accuracy beyond that of numbers ends too.
    const auto endless = press(bonded_layer{.accuracy = {.tolerance = 0, .max_iterations = 60}}, cell,
                               bumpy(), pressing::to_force(50));
    check_sane(endless, 60);
}

} // namespace
