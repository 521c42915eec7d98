#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/simulation/effect.hpp>
#include <tactnet/simulation/objects/object.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <cstdint>

// Frames to try effects on.

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

} // namespace support
