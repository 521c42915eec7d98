// Touches that no real hand makes: layers that cannot be squeezed and are thinner than a cell, all cells
// pressed, far too much force. References are dense matrices in long double (dense_contact.hpp).

#include "../hold.hpp"
#include "dense_contact.hpp"

#include <tactnet/simulation/contact/elastic.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
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
constexpr shape small{5, 7};
constexpr double cell = 2e-3, area = cell * cell;

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

} // namespace

TEST_CASE("bonded_layer: from soft to incompressible, from thin to thick") {
    for (const double poisson : {0.49, 0.5})
        for (const double thickness : {0.01, 0.1, 0.3, 1.0, 10.0, 100.0})
            check_layer(thickness, poisson);
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
