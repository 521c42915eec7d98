#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/simulation/effect.hpp>
#include <tactnet/simulation/objects/object.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <support/same_bits.hpp>

// Frames to try effects on, and what holds for every effect.

namespace support {

template <tactnet::shape Shape>
using frame = tactnet::tensor<float, Shape>;

/// Half of it nothing, the rest up to `most` pascals.
template <tactnet::shape Shape>
frame<Shape> pressed(std::uint32_t sample = 0, double most = 34e3) {
    tactnet::random_stream random(11, tactnet::random_purposes::touch, 0, sample);
    frame<Shape> pressures;
    for (float& pressure : pressures) {
        const double drawn = random.uniform(-most, most);
        pressure = drawn > 0 ? static_cast<float>(drawn) : 0;
    }
    return pressures;
}
template <tactnet::shape Shape>
frame<Shape> filled(float value) {
    frame<Shape> values;
    for (float& each : values)
        each = value;
    return values;
}

template <tactnet::shape Shape, class Effect>
frame<Shape> after(const Effect& effect, const frame<Shape>& before,
                   const tactnet::simulation::moment& now = {},
                   const tactnet::simulation::mounting& where = {}) {
    typename Effect::template bound<Shape> bound(effect, where);
    frame<Shape> values = before;
    bound.apply(values.view(), now);
    return values;
}

/// An effect without strength is no effect, whatever reaches it.
template <tactnet::shape Shape, class Effect>
void check_changes_no_bit(const Effect& effect) {
    const tactnet::simulation::moment now{.seconds = 100, .celsius = 60};
    for (std::uint32_t sample = 0; sample < 10; ++sample)
        CHECK(same_bits(after<Shape>(effect, pressed<Shape>(sample), now), pressed<Shape>(sample)));
    for (const float value : {-0.0f, -5.0f, 1e-40f, 1e30f})
        CHECK(same_bits(after<Shape>(effect, filled<Shape>(value), now), filled<Shape>(value)));
}

/// Finite values, however large, small or below zero, never become NaN; NaN is not hidden.
template <tactnet::shape Shape, class Effect>
void check_no_nan(const Effect& effect) {
    constexpr float most = std::numeric_limits<float>::max();
    const tactnet::simulation::moment now{.seconds = 1e9, .celsius = -300};
    for (const float value : {0.0f, -0.0f, 1e-45f, 1.0f, -1.0f, 34e3f, 1e20f, -1e20f, most, -most}) {
        CAPTURE(value);
        frame<Shape> mixed = pressed<Shape>();
        mixed.data()[Shape.size() / 2] = value;
        for (const frame<Shape>& values : {filled<Shape>(value), mixed}) {
            std::size_t nans = 0;
            for (const float result : after<Shape>(effect, values, now))
                nans += std::isnan(result);
            CHECK(nans == 0);
        }
    }
    frame<Shape> broken = pressed<Shape>();
    broken.data()[Shape.size() / 2] = std::numeric_limits<float>::quiet_NaN();
    CHECK(std::isnan(after<Shape>(effect, broken).data()[Shape.size() / 2]));
}

} // namespace support
