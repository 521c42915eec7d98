#include <tactnet/simulation/effect.hpp>
#include <tactnet/simulation/effects/circuit/dead_tactels.hpp>
#include <tactnet/simulation/effects/circuit/noise.hpp>
#include <tactnet/simulation/effects/film/drift.hpp>
#include <tactnet/simulation/effects/film/gain_map.hpp>
#include <tactnet/simulation/effects/film/texture.hpp>
#include <tactnet/simulation/objects/object.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <set>

namespace {

using namespace tactnet::simulation;
using tactnet::philox;

// Images made with one version of the library are those of the next: these numbers stay.
static_assert(tactnet::random_purposes::sensor.number() == 7);
static_assert(tactnet::random_purposes::frame.number() == 8);
static_assert(tactnet::random_purposes::touch.number() == 9);
static_assert(gain_map::purpose.number() == 0);
static_assert(dead_tactels::purpose.number() == 1);
static_assert(noise::purpose.number() == 2);
static_assert(drift::purpose.number() == 3);
static_assert(film_texture::purpose.number() == 7);

/// An effect as a user writes one, with random numbers of its own.
struct slip {
    static constexpr auto purpose = effect_purpose::named("my_gripper/slip");
};

TEST_CASE("sensor_unit: random numbers are those of its number and the use") {
    constexpr sensor_unit unit{0x0123'4567'89AB'CDEF};
    auto random = unit.random(noise::purpose);
    for (const std::uint32_t word : philox({0, 7, 0, 2}, {0x89AB'CDEF, 0x0123'4567}))
        CHECK(random.bits() == word);
}

TEST_CASE("moment: random numbers are those of its seed, its frame and the use") {
    constexpr moment now{.seed = 0x0123'4567'89AB'CDEF, .frame = 5};
    auto random = now.random(film_texture::purpose);
    for (const std::uint32_t word : philox({0, 8, 5, 7}, {0x89AB'CDEF, 0x0123'4567}))
        CHECK(random.bits() == word);
}

TEST_CASE("effect_purpose: every effect has numbers of its own, a user's too") {
    const std::array purposes{gain_map::purpose, dead_tactels::purpose, noise::purpose,
                              drift::purpose,    film_texture::purpose, slip::purpose};
    std::set<std::uint32_t> numbers, of_sensors, of_frames;
    for (const effect_purpose purpose : purposes) {
        numbers.insert(purpose.number());
        of_sensors.insert(sensor_unit{}.random(purpose).bits());
        of_frames.insert(moment{}.random(purpose).bits());
    }
    CHECK(numbers.size() == purposes.size());
    CHECK(of_sensors.size() == purposes.size());
    CHECK(of_frames.size() == purposes.size());
    CHECK(slip::purpose.number() >= 0x8000'0000);
}

} // namespace
