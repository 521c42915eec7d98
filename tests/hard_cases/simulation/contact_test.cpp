// Touches that no real hand makes: layers that cannot be squeezed and are thinner than a cell, all cells
// pressed, one tactel, no force and far too much, lines that are broken or shorted. References are closed
// forms and dense matrices in long double (dense_contact.hpp).

#include "../hold.hpp"
#include "dense_contact.hpp"

#include <tactnet/simulation/contact/bonded_layer.hpp>
#include <tactnet/simulation/contact/elastic_half_space.hpp>
#include <tactnet/simulation/contact/winkler.hpp>
#include <tactnet/simulation/objects/object.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <numbers>
#include <simulation/pressed.hpp>
#include <string>
#include <vector>

using namespace tactnet::simulation;
using hard_cases::hold;
using hard_cases::outcome;
using hard_cases::unit;
using tactnet::shape;
using tactnet::tensor;

namespace {

constexpr double u = 0x1p-24;
constexpr shape small{5, 7}, paper{28, 50};
constexpr double cell = 2e-3, area = cell * cell;
constexpr double infinite = std::numeric_limits<double>::infinity();

std::string text(double value) {
    char out[32];
    std::snprintf(out, sizeof(out), "%g", value);
    return out;
}

template <shape Shape>
std::vector<double> doubles(const tensor<float, Shape>& heights) {
    std::vector<double> all;
    for (const float height : heights)
        all.push_back(static_cast<double>(height));
    return all;
}

/// How far pressures are from being those of a contact, as a share of the depth: gaps where there is
/// pressure, overlaps where there is none.
template <class Pressures>
double amiss(const hard_cases::dense_surface& surface, const std::vector<double>& heights,
             const Pressures& pressures, double depth) {
    double most = 0;
    for (std::size_t i = 0; i < heights.size(); ++i) {
        long double gap = static_cast<long double>(heights[i]) - depth;
        for (std::size_t j = 0; j < heights.size(); ++j)
            gap += surface.between(i, j) * static_cast<long double>(pressures[j]);
        const auto wrong = static_cast<double>(pressures[i] > 0 ? std::abs(gap) : -gap);
        if (std::isnan(wrong))
            return wrong;
        most = std::max(most, wrong / depth);
    }
    return most;
}

/// A ball of 2 cm, lengths in cells.
tensor<float, small> ball_in_cells() {
    return support::heights_of<small>(1, support::sphere(10));
}

/// The solver's tolerance, pressures rounded to float, and what a layer's coefficients are off by: 1e-6 of
/// the thickness by which a cell's own is raised and as much by quadrature, 1e-7 for all others.
void check_layer(double thickness, double poisson) {
    const auto surface = hard_cases::dense_layer(small.rows, small.columns, thickness, poisson);
    const auto heights = ball_in_cells();
    const bonded_layer model{.young = 1 - poisson * poisson, .poisson = poisson, .thickness = thickness};
    const auto found = support::press(model, 1, heights, pressing::to_depth(0.3));
    REQUIRE(found.report.converged);
    const std::vector<float> pressures(found.pressures.begin(), found.pressures.end());
    double bound = 0;
    const double thin = std::min(thickness, 1.0);
    for (std::size_t i = 0; i < small.size(); ++i) {
        double rounded = 0, all = 0;
        for (std::size_t j = 0; j < small.size(); ++j) {
            const auto pressure = static_cast<double>(pressures[j]);
            rounded += u * std::abs(static_cast<double>(surface.between(i, j))) * pressure;
            all += pressure;
        }
        bound = std::max(bound, rounded + thin * (2e-6 * static_cast<double>(pressures[i]) + 1e-7 * all));
    }
    const std::string name =
        "ν " + text(poisson) + ", a layer of " + text(thickness) + (thickness == 1 ? " cell" : " cells");
    hold(name + ": gaps and overlaps ÷ depth", unit::absolute,
         {0, amiss(surface, doubles(heights), pressures, 0.3), 1e-6 + bound / 0.3});
}

/// Three feet on bumpy ground, and a plate: what takes the solver longest.
void count_iterations(double thickness, double poisson) {
    const auto bumpy = support::heights_of<paper>(cell, [](double y, double x) {
        const double foot = std::min({(x * x + y * y) / 0.02, 3e-4 + std::pow(x - 0.03, 2) / 0.01,
                                      std::hypot(x + 0.03, y - 0.01) < 0.008 ? 1e-4 : infinite});
        return foot + 2e-5 * std::sin(3e3 * x) * std::cos(2e3 * y);
    });
    bonded_layer::bound<paper> bound(
        bonded_layer{.young = 1e5, .poisson = poisson, .thickness = thickness * cell}, cell);
    std::size_t most = 0;
    const auto count = [&](const tensor<float, paper>& heights, const pressing& how) {
        tensor<float, paper> pressures;
        const contact_report report = bound.solve(heights.view(), how, pressures.view());
        CHECK(report.converged);
        most = std::max(most, report.iterations);
    };
    for (const double force : {0.05, 5.0, 500.0})
        count(bumpy, pressing::to_force(force));
    for (const double depth : {5e-5, 1e-3})
        count(bumpy, pressing::to_depth(depth));
    count({}, pressing::to_force(20));
    CHECK(most <= 150); // of 500
}

} // namespace

TEST_CASE("bonded_layer: from soft to incompressible, from thin to thick") {
    for (const double poisson : {0.49, 0.5})
        for (const double thickness : {0.01, 0.1, 0.3, 1.0, 10.0, 100.0})
            check_layer(thickness, poisson);
}

TEST_CASE("bonded_layer: steps of the solver, from thin to thick") {
    for (const double poisson : {0.49, 0.499, 0.4999, 0.5})
        for (const double thickness : {0.01, 0.03, 0.1, 0.3, 1.0, 10.0, 100.0})
            count_iterations(thickness, poisson);
}

namespace {

/// The same contact by elimination. What the solver leaves of gaps, twice its tolerance with the level's,
/// becomes pressure by the inverse; 1e-12 for its sums in double.
template <shape Shape>
void check_half_space(const std::string& name, const tensor<float, Shape>& heights, double force,
                      std::size_t cells) {
    const auto surface = hard_cases::dense_half_space(Shape.rows, Shape.columns);
    // Metres to cells, and E / (1 − ν²) = 1: depths are in cells, pressures in pascals.
    constexpr double modulus = 1e6 / 0.75;
    std::vector<double> in_cells = doubles(heights);
    for (double& height : in_cells)
        height *= modulus / cell;
    const auto exact = hard_cases::pressed_to(surface, in_cells, force / area);
    const auto found = support::press(elastic_half_space{}, cell, heights, pressing::to_force(force));
    CHECK(found.report.converged);
    CHECK(found.report.cells == cells);
    std::vector<outcome> all;
    for (std::size_t i = 0; i < Shape.size(); ++i) {
        const auto pressure = static_cast<double>(exact.pressures[i]);
        if (pressure > 0)
            all.push_back(
                {pressure, static_cast<double>(found.pressures.data()[i]),
                 u + 1e-12 + static_cast<double>(2e-6L * exact.depth * exact.sensitivity) / pressure});
    }
    hold(name + ": pressures", unit::relative, all);
    const auto depth = static_cast<double>(exact.depth) / modulus * cell;
    hold(name + ": depth", unit::relative, {depth, found.report.depth, 2e-6});
}

} // namespace

TEST_CASE("elastic_half_space: all cells in contact, forces of 1e-12 and 1e9 N") {
    const auto plate = tensor<float, small>{};
    const auto ball = support::heights_of<small>(cell, support::sphere(0.02));
    check_half_space("half space, a plate, full contact", plate, 5, small.size());
    check_half_space("half space, a ball, full contact, 1e9 N", ball, 1e9, small.size());
    check_half_space("half space, a ball, 1e-12 N", ball, 1e-12, 1);
}

namespace {

/// Sums of 1400 springs in double: 1e-12.
void check_springs(const std::string& name, double lift, double force) {
    auto ball = support::heights_of<paper>(cell, support::sphere(0.02));
    for (float& height : ball)
        height += static_cast<float>(lift);
    const winkler foam{};
    const auto found = support::press(foam, cell, ball, pressing::to_force(force));
    double sum = 0;
    for (const float pressure : found.pressures)
        sum += static_cast<double>(pressure) * area;
    hold(name + ": reported force", unit::relative, {force, found.report.force, 1e-12});
    hold(name + ": sum of the pressures", unit::relative, {force, sum, u + 1e-12});
}

} // namespace

TEST_CASE("winkler: forces of 1e-12 and 1e9 N, near and far from the origin of heights") {
    check_springs("springs, a ball, 1e-12 N", 0, 1e-12);
    check_springs("springs, a ball, 1e9 N", 0, 1e9);
    check_springs("springs, a ball lifted by 0.25 m, 1e-12 N", 0.25, 1e-12);
    check_springs("springs, a ball lifted by 0.25 m, 1 N", 0.25, 1);
}

namespace {

constexpr shape one_tactel{1, 1};

/// All of the force on one cell: its pressure, and the depth by the answer of a cell to itself.
template <class Model>
void check_one(const std::string& name, const Model& model, double sinking, double bound) {
    for (const double force : {1e-12, 3.0, 1e9}) {
        const auto found =
            support::press(model, cell, tensor<float, one_tactel>{}, pressing::to_force(force));
        CHECK(found.report.converged);
        const double pressure = force / area, depth = pressure * sinking;
        hold("one tactel on " + name + ", " + text(force) + " N: pressure", unit::relative,
             {pressure, static_cast<double>(found.pressures(0, 0)), u + 1e-15});
        hold("one tactel on " + name + ", " + text(force) + " N: depth", unit::relative,
             {depth, found.report.depth, bound});
    }
}

/// No force is no pressure; shares of a force that is none would be 0 ÷ 0.
template <class Model>
void check_none(const std::string& name, const Model& model) {
    const auto ball = support::heights_of<small>(cell, support::sphere(0.02));
    const auto found = support::press(model, cell, ball, pressing::to_force(0));
    CHECK(found.report.converged);
    INFO(name);
    CHECK(found.report.force == 0);
    CHECK(found.report.depth == 0);
    for (const float pressure : found.pressures)
        CHECK(pressure == 0);
}

} // namespace

// Love's formula in the middle of a square is 4 asinh(1) ÷ π. A layer's own answer is off by 2e-6 cells.
TEST_CASE("contact: one tactel, and no force") {
    const double square = 4 * std::asinh(1.0) * cell / std::numbers::pi;
    check_one("springs", winkler{}, winkler{}.thickness / winkler{}.modulus, 1e-15);
    check_one("a half space", elastic_half_space{}, square * 0.75 / 1e6, 1e-14);
    const auto surface = hard_cases::dense_layer(1, 1, 1.5, 0.3);
    const auto own = static_cast<double>(surface.sinking[0]);
    check_one("a layer", bonded_layer{}, own * cell * (1 - 0.3 * 0.3) / 1e5, 2e-6 / own);
    check_none("springs", winkler{});
    check_none("a half space", elastic_half_space{});
    check_none("a layer", bonded_layer{});
}

// A wire of 0.2 mm between two rows of tactels of 2 mm: the heights are those of the middles of cells, of
// which it covers none. Cells of 0.4 mm see it from the middle of a row to half a cell away from it.
TEST_CASE("compute_heights: objects thinner than a tactel") {
    const object wire{.parts = {rod{{-0.005, 0}, {0.005, 0}, 1e-4, 1e-4}}};
    const auto found = [&]<shape Shape>(double of_cell, double beside) {
        tensor<float, Shape> heights;
        compute_heights<Shape>(wire, {.position = {0, beside}}, of_cell, heights.view());
        return support::press(elastic_half_space{}, of_cell, heights, pressing::to_force(1)).report;
    };
    const auto between = found.operator()<shape{4, 6}>(2e-3, 0);
    CHECK_FALSE(between.converged);
    CHECK(between.force == 0);
    const auto above = found.operator()<shape{4, 6}>(2e-3, 1e-3),
               fine = found.operator()<shape{20, 30}>(4e-4, 2e-4);
    CHECK(above.converged);
    CHECK(fine.converged);
    hold("a wire of 0.2 mm above a row: force", unit::relative, {1, above.force, 1e-14});
    hold("a wire of 0.2 mm, 5 × 5 cells per tactel: force", unit::relative, {1, fine.force, 1e-13});
}
