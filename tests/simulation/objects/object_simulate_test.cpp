#include "witness.hpp"

#include <tactnet/simulation/objects/object.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>

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
