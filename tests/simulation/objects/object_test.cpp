#include "witness.hpp"

#include <tactnet/simulation/objects/object.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace {

using namespace tactnet::simulation;

constexpr tactnet::shape size{21, 31};
constexpr double cell = 1e-3;

/// Metres, to a nanometre; doctest's own tolerance would be 12 µm.
doctest::Approx metres(double length) {
    return doctest::Approx(length).epsilon(1e-9).scale(1);
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

} // namespace

namespace {

using namespace support;

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
