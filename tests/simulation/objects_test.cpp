#include "witness.hpp"

#include <tactnet/simulation/objects/object.hpp>
#include <tactnet/simulation/objects/part.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace {

using namespace tactnet::simulation;
using namespace support;

constexpr tactnet::shape size{21, 31};
constexpr double cell = 1e-3;

/// Metres, to a nanometre; doctest's own tolerance would be 12 µm.
doctest::Approx metres(double length) {
    return doctest::Approx(length).epsilon(1e-9).scale(1);
}

double round(double radius, double distance) {
    return radius - std::sqrt(radius * radius - distance * distance);
}

TEST_CASE("part: a rod of no length is a sphere") {
    const rod ball = rod::sphere({0.01, -0.02}, 0.03, 0.001);
    CHECK(ball.height({0.01, -0.02}) == metres(0.001));
    CHECK(ball.height({0.02, -0.02}) == metres(0.001 + round(0.03, 0.01)));
    CHECK(ball.height({0.01, 0.005}) == metres(0.001 + round(0.03, 0.025)));
    CHECK(ball.height({0.0399, -0.02}) == metres(0.001 + round(0.03, 0.0299)));
    CHECK(ball.height({0.0401, -0.02}) == nothing);
}

TEST_CASE("part: a rod is a cylinder along its axis, round at its ends, and a cone between two radii") {
    const rod bar{{0, 0}, {0.1, 0}, 0.004, 0.004};
    for (const double along : {0.0, 0.03, 0.1})
        CHECK(bar.height({along, 0.003}) == metres(round(0.004, 0.003)));
    CHECK(bar.height({0.103, 0}) == metres(round(0.004, 0.003)));
    CHECK(bar.height({0.1041, 0}) == nothing);

    const rod cone{{0, 0}, {0.1, 0}, 0.002, 0.006, 0, 0.001};
    CHECK(cone.height({0.05, 0.003}) == metres(0.0005 + round(0.004, 0.003)));
    CHECK(cone.height({0, 0.003}) == nothing);
}

TEST_CASE("part: an arc is round along its circle and ends where it should") {
    const arc half{{0, 0}, 0.02, 0.003, 0, std::numbers::pi, 0, 0.002};
    CHECK(half.height({0.02, 0}) == metres(0));
    CHECK(half.height({0, 0.021}) == metres(0.001 + round(0.003, 0.001)));
    CHECK(half.height({-0.02, 0}) == metres(0.002));
    CHECK(half.height({0, -0.02}) == nothing);
    CHECK(half.height({-0.02, -0.002}) == metres(0.002 + round(0.003, 0.002))); // its round end
    CHECK(half.height({0, 0}) == nothing);

    const arc ring{{0, 0}, 0.02, 0.003};
    for (int degree = 0; degree < 360; degree += 7)
        CHECK(ring.height(0.0215 * point::at_angle(degree * std::numbers::pi / 180)) ==
              metres(round(0.003, 0.0015)));
}

TEST_CASE("part: arcs of no angle, of less than none and of more than a turn") {
    const arc ball{{0, 0}, 0.02, 0.003, 1, 1, 0.004, 0.004};
    CHECK(ball.height(0.02 * point::at_angle(1)) == metres(0.004));
    CHECK(ball.height(0.022 * point::at_angle(1)) == metres(0.004 + round(0.003, 0.002)));
    CHECK(ball.height(0.02 * point::at_angle(1.2)) == nothing);

    const double degree = std::numbers::pi / 180;
    const arc over_zero{{0, 0}, 0.02, 0.001, 350 * degree, 10 * degree, 0, 0.002};
    CHECK(over_zero.height({0.02, 0}) == metres(0.001));
    CHECK(over_zero.height({-0.02, 0}) == nothing);

    const arc twice{{0, 0}, 0.02, 0.003, 0, 4 * std::numbers::pi, 0, 0.002};
    CHECK(twice.height({-0.02, 0}) == metres(0.001));
}

TEST_CASE("part: a round bar without a radius, or with one that is no number, is nothing") {
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (const double radius : {0.0, -0.01, none}) {
        CAPTURE(radius);
        CHECK(rod{{0, 0}, {0.1, 0}, radius, radius}.height({0.05, 0}) == nothing);
        CHECK(rod::sphere({}, radius).height({}) == nothing);
        CHECK(arc{{0, 0}, 0.02, radius}.height({0.02, 0}) == nothing);
    }
    CHECK(rod{{0, 0}, {none, 0}, 0.004, 0.004}.height({0, 0}) == nothing);
}

TEST_CASE("part: a plate is flat inside its rim, and hollow if asked") {
    const plate box{.centre = {}, .half_length = 0.02, .half_width = 0.01, .corner = 0.002, .rim = 0.003};
    CHECK(box.height({0, 0}) == 0);
    CHECK(box.height({0.0165, 0}) == 0);
    CHECK(box.height({0.019, 0}) == metres(round(0.003, 0.002)));
    CHECK(box.height({0, 0.009}) == metres(round(0.003, 0.002)));
    CHECK(box.height({0.0201, 0}) == nothing);
    CHECK(box.height({0.0199, 0.0099}) == nothing); // beyond the rounded corner

    const plate turned{.centre = {}, .half_length = 0.02, .half_width = 0.01, .angle = std::numbers::pi / 2};
    CHECK(turned.height({0, 0.0199}) == 0);
    CHECK(turned.height({0.0101, 0}) == nothing);
    const plate oblique{.centre = {}, .half_length = 0.02, .half_width = 0.01, .angle = 0.5};
    CHECK(oblique.height(0.0199 * point::at_angle(0.5)) == 0);
    CHECK(oblique.height(0.0199 * point::at_angle(-0.5)) == nothing);

    const plate hollow{.centre = {},
                       .half_length = 0.02,
                       .half_width = 0.01,
                       .hollow = 0.001,
                       .hollow_width = 0.004,
                       .lift = 0.0005};
    CHECK(hollow.height({0, 0}) == metres(0.0015));
    CHECK(hollow.height({0, 0.008}) == metres(0.0010));                  // half way in
    CHECK(hollow.height({0, 0.009}) == metres(0.0005 + 0.001 * 5 / 32)); // 3t² − 2t³ at ¼
    CHECK(hollow.height({0, 0.0099999}) == metres(0.0005));

    const plate disc = plate::disc({}, 0.01);
    CHECK(disc.height({0.00706, 0.00706}) == 0);
    CHECK(disc.height({0.0072, 0.0072}) == nothing);
}

TEST_CASE("part: a plate's corner takes no more than it has, and a hollow of no width all of it") {
    const plate pill{.centre = {}, .half_length = 0.02, .half_width = 0.01, .corner = 1};
    CHECK(pill.height({0.0199, 0}) == 0);
    CHECK(pill.height({0, 0.0099}) == 0);
    CHECK(pill.height({0.0175, 0.0075}) == nothing);

    const plate raised{
        .centre = {}, .half_length = 0.02, .half_width = 0.01, .hollow = 0.001, .hollow_width = 0};
    CHECK(raised.height({0.0199, 0}) == 0.001);
    CHECK(raised.height({0.0201, 0}) == nothing);
}

TEST_CASE("part: a relief is bilinear between its points and nothing beyond them") {
    const float none = std::numeric_limits<float>::infinity();
    const relief map{{0, 0}, 2, 3, 0.01, {0, 1, 2, 3, 5, none}, 10};
    CHECK(map.height({-0.01, -0.005}) == 10);
    CHECK(map.height({0, -0.005}) == 11);
    CHECK(map.height({0, 0.005}) == 15);
    CHECK(map.height({-0.005, 0}) == metres(10 + (0 + 1 + 3 + 5) / 4.0));
    CHECK(map.height({0.005, 0.001}) == nothing);
    CHECK(map.height({0.01, -0.005}) == metres(12)); // a neighbour of no weight counts for nothing
    CHECK(map.height({0.0149, -0.0099}) == 12);      // half a cell beyond the last point
    CHECK(map.height({0.0151, -0.005}) == nothing);
    CHECK(map.height({-0.0151, 0}) == nothing);
    CHECK(map.height({0, 0.0101}) == nothing);
    CHECK(map.height({0, -0.0101}) == nothing);

    const relief gap{{0, 0}, 1, 2, 0.01, {none, 3}};
    CHECK(gap.height({-0.004, 0}) == nothing);
    CHECK(gap.height({0.004, 0}) == nothing);
    CHECK(gap.height({0.005, 0}) == 3);
}

TEST_CASE("part: a relief of one row is a strip, of none nothing, of too few heights an error") {
    const relief row{{0, 0}, 1, 3, 0.01, {0, 1, 2}};
    CHECK(row.height({0.005, 0.0049}) == metres(1.5));
    CHECK(row.height({0.005, 0.0051}) == nothing);
    CHECK(relief{{0, 0}, 0, 0, 0.01, {}}.height({0, 0}) == nothing);
    const relief broken{{0, 0}, 2, 3, 0.01, {0, 1, 2}};
    CHECK_THROWS_WITH_AS(static_cast<void>(broken.height({0, 0})), "relief: expected 2 x 3 heights, found 3",
                         std::invalid_argument);
}

tactnet::tensor<float, size> laid(const object& body, const pose& at) {
    tactnet::tensor<float, size> heights;
    compute_heights<size>(body, at, cell, heights.view());
    return heights;
}

TEST_CASE("object: its pose is x along the columns, y along the rows, turned from x to y") {
    const object ball{{rod::sphere({5e-3, 0}, 1.6e-3)}, {}};
    CHECK(laid(ball, {})(10, 20) == 0);
    CHECK(laid(ball, {.position = {2e-3, -3e-3}})(7, 22) == 0);
    CHECK(laid(ball, {.angle = std::numbers::pi / 2})(15, 15) == metres(0));
    CHECK(laid(ball, {.position = {-4e-3, 1e-3}, .angle = std::numbers::pi})(11, 6) == metres(0));
    CHECK(std::isinf(laid(ball, {})(10, 23)));
}

TEST_CASE("object: a slope raises it along x and y, from where it lies") {
    const object face{{plate{.centre = {}, .half_length = 1, .half_width = 1}}, {}};
    const auto heights = laid(face, {.position = {1e-3, 0}, .angle = 1, .slope = {0.1, -0.2}});
    CHECK(heights(10, 16) == metres(0));
    CHECK(heights(10, 20) == metres(0.4e-3));
    CHECK(heights(13, 16) == metres(-0.6e-3));
}

TEST_CASE("object: of several parts the lowest counts") {
    const object two{{rod::sphere({}, 4e-3, 1e-3), rod::sphere({3e-3, 0}, 4e-3)}, {}};
    CHECK(two.height({0, 0}) == metres(1e-3));
    CHECK(two.height({2e-3, 0}) == metres(4e-3 - std::sqrt(16e-6 - 1e-6)));
    CHECK(two.height({-3e-3, 0}) == metres(1e-3 + 4e-3 - std::sqrt(16e-6 - 9e-6)));
    CHECK(object{}.height({0, 0}) == nothing);
}

TEST_CASE("object: a height map of the array's size reaches all of its tactels, whatever rounding does to "
          "its rim") {
    const double odd_cell = 1.903e-3;
    const object map{{relief{{}, size.rows, size.columns, odd_cell, std::vector<float>(size.size(), 1e-3f)}},
                     {}};
    tactnet::tensor<float, size> heights;
    for (const double shift : {0.0, 1e-3, 7e-3, 0.1}) {
        object moved = map;
        std::get<relief>(moved.parts[0]).centre = {shift, -shift};
        compute_heights<size>(moved, {.position = {-shift, shift}}, odd_cell, heights.view());
        CHECK(std::ranges::all_of(heights, [](float height) { return height == 1e-3f; }));
    }
}

TEST_CASE("object: roughness stays within its amplitude, is continuous, and varies over its wavelength") {
    const roughness bumps{2e-4, 3e-3, 7};
    double lowest = 1, highest = 0, steepest = 0;
    for (int i = -4000; i < 4000; ++i) {
        const point place{i * 1e-5, i * 0.7e-5};
        const double height = bumps.height(place);
        lowest = std::min(lowest, height), highest = std::max(highest, height);
        steepest = std::max(steepest, std::abs(height - bumps.height(place + point{1e-6, 0})));
    }
    CHECK(lowest >= 0);
    CHECK(lowest < 0.4e-4);
    CHECK(highest <= 2e-4);
    CHECK(highest > 1.6e-4);
    CHECK(steepest <= 1.5 * 2e-4 * 1e-6 / 3e-3 * 1.0001); // the steepest of 3t² − 2t³
    CHECK(roughness{0, 3e-3, 7}.height({1e-3, 1e-3}) == 0);
    for (const double no_wave : {0.0, 1e-310, std::numeric_limits<double>::quiet_NaN()})
        for (const point place : {point{1e-3, 0}, point{0, 1e-3}})
            CHECK(roughness{2e-4, no_wave, 7}.height(place) == 0);
    CHECK(roughness{2e-4, 3e-3, 8}.height({1e-3, 1e-3}) != bumps.height({1e-3, 1e-3}));
}

TEST_CASE("simulate: a frame is that of the heights, the pressing and the moment") {
    const touch ball{{{rod::sphere({}, 0.02)}, {}}, {.position = {4e-3, -2e-3}}, pressing::to_depth(5e-4)};
    watched scene({}, {.number = 77});
    watched::frames result, expected;
    const moment now{.seed = 0xFEDC'BA98'7654'3210, .frame = 0xFFFF'FFFF};
    simulate(scene, ball, now, result);
    CHECK(said(result, 0) == 77);
    CHECK(said(result, 1) == now.seed);
    CHECK(said(result, 2) == now.frame);
    tactnet::tensor<float, watched::surface> heights;
    compute_heights<watched::surface>(ball.shape, ball.at, scene.cell(), heights.view());
    scene.touch(heights.view(), ball.press, now, expected);
    CHECK(std::ranges::equal(result.clean, expected.clean));
    CHECK(result.contact.depth == doctest::Approx(5e-4).epsilon(1e-9).scale(0));
}

} // namespace
