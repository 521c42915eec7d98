#include "pressed.hpp"

#include <tactnet/simulation/bonded_layer.hpp>
#include <tactnet/simulation/dead_tactels.hpp>
#include <tactnet/simulation/gain_map.hpp>
#include <tactnet/simulation/hysteresis.hpp>
#include <tactnet/simulation/noise.hpp>
#include <tactnet/simulation/object.hpp>
#include <tactnet/simulation/pad.hpp>
#include <tactnet/simulation/quantisation.hpp>
#include <tactnet/simulation/saturation.hpp>
#include <tactnet/simulation/scene.hpp>
#include <tactnet/simulation/tactel_average.hpp>
#include <tactnet/simulation/winkler.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>

namespace {

using namespace tactnet::simulation;

using plain = scene<array<8, 12>, contact<winkler>>;
using whole = scene<array<8, 12>, contact<winkler>, tactel_average<3>, saturation, quantisation<8>>;
static_assert(plain::surface == tactnet::shape{8, 12} && plain::output == plain::tactels);
static_assert(whole::surface == tactnet::shape{24, 36} && whole::output == tactnet::shape{8, 12});

TEST_CASE("a scene presses to the force that it is given") {
    whole touch;
    tactnet::tensor<float, whole::surface> heights;
    for (std::size_t row = 0; row < whole::surface.rows; ++row)
        for (std::size_t column = 0; column < whole::surface.columns; ++column) {
            const double y = (static_cast<double>(row) - 11.5) * touch.cell(),
                         x = (static_cast<double>(column) - 17.5) * touch.cell();
            heights(row, column) = static_cast<float>((x * x + y * y) / (2 * 0.02));
        }
    whole::frames result;
    touch.touch(heights, pressing::to_force(1), {}, result);
    CHECK(result.contact.converged);
    CHECK(result.contact.force == doctest::Approx(1).epsilon(1e-9));
    double sum = 0;
    for (const float pressure : result.clean)
        sum += static_cast<double>(pressure);
    CHECK(sum * touch.sensor().tactel_area() == doctest::Approx(1).epsilon(1e-6));
}

TEST_CASE("a scene with the accurate contact and a pad") {
    using accurate = scene<array<14, 16>, contact<bonded_layer>, elastic_pad, tactel_average<2>>;
    accurate touch({}, {}, elastic_pad{.thickness = 5e-4}, contact<bonded_layer>{{.poisson = 0.4}});
    const auto heights = support::heights_of<accurate::surface>(touch.cell(), support::sphere(0.01));
    accurate::frames result;
    touch.touch(heights, pressing::to_force(2), {}, result);
    CHECK(result.contact.converged);
    CHECK(result.contact.force == doctest::Approx(2).epsilon(1e-9));
    CHECK(support::sum_of(result.measured) * touch.sensor().tactel_area() ==
          doctest::Approx(2).epsilon(1e-3));
}

TEST_CASE("a scene that goes on with another sensor is a scene of that sensor") {
    using faulty =
        scene<array<8, 12>, contact<winkler>, elastic_pad, gain_map, hysteresis, noise, dead_tactels>;
    const object ball{{rod::sphere({1e-3, 2e-3}, 0.02)}, {}};
    tactnet::tensor<float, faulty::surface> heights;
    lay<faulty::surface>(ball, {}, 1.9e-3, heights.view());
    const auto frame = [&](faulty& scene) {
        faulty::frames result;
        scene.touch(heights, pressing::to_force(2), {.frame = 3}, result);
        return result.measured;
    };
    const dead_tactels dead{.single = 0.1};
    faulty first({}, {1}, dead), second({}, {2}, dead);
    const auto of_second = frame(second);
    CHECK(!std::ranges::equal(frame(first), of_second));
    first.use({2});
    CHECK(std::ranges::equal(frame(first), of_second));
}

} // namespace
