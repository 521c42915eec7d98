#include <tactnet/simulation/effects/film/texture.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace {

using namespace tactnet::simulation;

constexpr tactnet::shape size{28, 50};
using map = tactnet::tensor<float, size>;

map textured(const film_texture& effect, float pressure, std::uint64_t unit, std::uint32_t frame) {
    map values;
    std::ranges::fill(values, pressure);
    film_texture::bound<size>(effect, mounting{.unit = {unit}}).apply(values.view(), {.frame = frame});
    return values;
}

double deviation(const map& values, double middle) {
    double sum = 0;
    for (const float value : values)
        sum += std::pow(static_cast<double>(value) - middle, 2);
    return std::sqrt(sum / static_cast<double>(map::size()));
}

// Of 1400 tactels the measured deviation itself varies by 1 / √2800 = 1.9 %; five of these.
constexpr double tolerance = 5 * 0.019;

TEST_CASE("texture: the deviation grows with the square root of the pressure") {
    for (const float pressure : {2e3f, 8e3f, 32e3f}) {
        CAPTURE(pressure);
        const auto p = static_cast<double>(pressure);
        const film_texture effect;
        CHECK(deviation(textured({effect.fixed, 0}, pressure, 1, 0), p) ==
              doctest::Approx(effect.fixed * std::sqrt(p)).epsilon(tolerance));
        CHECK(deviation(textured({0, effect.varying}, pressure, 1, 0), p) ==
              doctest::Approx(effect.varying * std::sqrt(p)).epsilon(tolerance));
    }
}

TEST_CASE("texture: one part stays with the sensor, the other changes from frame to frame") {
    CHECK(std::ranges::equal(textured({20, 0}, 1e4f, 1, 0), textured({20, 0}, 1e4f, 1, 9)));
    CHECK(!std::ranges::equal(textured({20, 0}, 1e4f, 1, 0), textured({20, 0}, 1e4f, 2, 0)));
    CHECK(!std::ranges::equal(textured({0, 20}, 1e4f, 1, 0), textured({0, 20}, 1e4f, 1, 1)));
}

TEST_CASE("texture: none changes no bit, where nothing presses nothing is felt, and no reading is "
          "below zero") {
    map values;
    for (std::size_t i = 0; i < map::size(); ++i)
        values.data()[i] = static_cast<float>(i * i) * 0.0371f;
    map same = values;
    film_texture::bound<size>(film_texture{0, 0}, {}).apply(same.view(), {});
    CHECK(std::ranges::equal(same, values));
    CHECK(std::ranges::all_of(textured({}, 0, 1, 0), [](float value) { return value == 0; }));
    CHECK(std::ranges::all_of(textured({200, 200}, 100, 1, 0), [](float value) { return value >= 0; }));
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    CHECK(std::ranges::all_of(textured({}, none, 1, 0), [](float value) { return std::isnan(value); }));
}

} // namespace
