#include <tactnet/simulation/objects/object.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace {

using namespace tactnet;
using namespace tactnet::simulation;

constexpr std::size_t draws = 2000;
const random_stream shapes(1, random_purposes::touch, 0, 0), poses(1, random_purposes::touch, 0, 1),
    forces(1, random_purposes::touch, 0, 2);

TEST_CASE("drawing: forces are log-uniform: half of them below the geometric mean") {
    drawing draw(shapes, poses, forces);
    std::size_t below = 0;
    for (std::size_t i = 0; i < draws; ++i) {
        const pressing press = draw.pressed(2, 18);
        CHECK(press.until == pressing::goal::force);
        CHECK(press.amount >= 2);
        CHECK(press.amount <= 18);
        below += press.amount < 6;
    }
    // Five standard deviations of a count.
    CHECK(std::abs(static_cast<double>(below) - draws / 2.0) < 5 * std::sqrt(draws / 4.0));
}

TEST_CASE("drawing: poses stay within their range, and their tilt has its deviation along both axes") {
    drawing draw(shapes, poses, forces);
    const pose_range range{{1, 2}, {0.25, 0.5}, 0.5, 0.75, 3e-3};
    double along = 0, across = 0;
    std::array<double, 3> least{9, 9, 9}, most{};
    for (std::size_t i = 0; i < draws; ++i) {
        const pose at = draw.somewhere(range);
        along += at.slope.x * at.slope.x, across += at.slope.y * at.slope.y;
        const std::array<double, 3> drawn{at.position.x, at.position.y, at.angle};
        for (std::size_t k = 0; k < drawn.size(); ++k)
            least[k] = std::min(least[k], drawn[k]), most[k] = std::max(most[k], drawn[k]);
    }
    const std::array<double, 3> low{0.75, 1.5, 0.5}, high{1.25, 2.5, 0.75};
    for (std::size_t k = 0; k < low.size(); ++k) {
        const double margin = 0.01 * (high[k] - low[k]); // all of 2000 miss it once in 5 · 10⁸
        CHECK(least[k] >= low[k]);
        CHECK(least[k] < low[k] + margin);
        CHECK(most[k] <= high[k]);
        CHECK(most[k] > high[k] - margin);
    }
    // A deviation of n numbers itself varies by 1 / √2n; five of these.
    const double tolerance = 5 / std::sqrt(2.0 * draws);
    CHECK(std::sqrt(along / draws) == doctest::Approx(3e-3).epsilon(tolerance).scale(0));
    CHECK(std::sqrt(across / draws) == doctest::Approx(3e-3).epsilon(tolerance).scale(0));
}

TEST_CASE("drawing: a named point of an object lies where the object would") {
    const pose_range range{{1e-3, 2e-3}, {5e-3, 5e-3}};
    for (std::uint32_t i = 0; i < 20; ++i) {
        const random_stream where(1, random_purposes::touch, i, 1);
        const pose plain = drawing(shapes, where, forces).somewhere(range),
                   named = drawing(shapes, where, forces).somewhere(range, {12 * mm, 3 * mm});
        CHECK(named.angle == plain.angle);
        const object dot{{rod::sphere({12 * mm, 3 * mm}, 1e-3)}, {}};
        const point from_object = (plain.position - named.position).turned(-named.angle);
        CHECK(std::abs(dot.height(from_object)) < 1e-12);
    }
}

TEST_CASE("drawing: an object that deforms is pressed like any other") {
    const pressing press = soft(pressing::to_force(7), 15e3, 8 * mm);
    CHECK(press.amount == 7);
    CHECK(press.object_modulus == 15e3);
    CHECK(press.object_thickness == 8 * mm);
}

TEST_CASE("drawing: counts reach both of their ends, and chance has its probability") {
    drawing draw(shapes, poses, forces);
    std::array<std::size_t, 6> seen{};
    std::size_t yes = 0, left = 0;
    for (std::size_t i = 0; i < draws; ++i) {
        ++seen.at(draw.count(2, 4));
        yes += draw.chance(0.3);
        left += draw.sign() < 0;
        CHECK(std::abs(draw.around(7, 2) - 7) <= 2);
    }
    for (const std::size_t number : {2u, 3u, 4u})
        CHECK(std::abs(static_cast<double>(seen[number]) - draws / 3.0) < 5 * std::sqrt(draws * 2 / 9.0));
    CHECK(std::abs(static_cast<double>(yes) - 0.3 * draws) < 5 * std::sqrt(0.21 * draws));
    CHECK(std::abs(static_cast<double>(left) - 0.5 * draws) < 5 * std::sqrt(0.25 * draws));
}

TEST_CASE("drawing: shape, pose and force are drawn apart: more draws of one change no other") {
    drawing one(shapes, poses, forces), other(shapes, poses, forces);
    static_cast<void>(other.within(0, 1));
    CHECK(one.somewhere({}).angle == other.somewhere({}).angle);
    static_cast<void>(other.somewhere({}));
    CHECK(one.pressed(1, 2).amount == other.pressed(1, 2).amount);
}

TEST_CASE("drawing: a bent bar is a rod from each bend to the next") {
    std::vector<part> parts;
    add_bar(parts, std::array{bend{{0, 0}, 1, 0.1}, bend{{4, 0}, 2, 0.2}, bend{{4, 4}, 3, 0.3}});
    REQUIRE(parts.size() == 2);
    CHECK(simulation::height(parts[0], {0, 0}) == doctest::Approx(0.1));
    CHECK(simulation::height(parts[0], {4, 0}) == doctest::Approx(0.2));
    CHECK(simulation::height(parts[1], {4, 0}) == doctest::Approx(0.2));
    CHECK(simulation::height(parts[1], {4, 4}) == doctest::Approx(0.3));
    CHECK(simulation::height(parts[1], {6.9, 4}) == doctest::Approx(0.3 + 3 - std::sqrt(9 - 2.9 * 2.9)));
}

} // namespace
