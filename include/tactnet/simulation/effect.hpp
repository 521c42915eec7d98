#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>

// Effects of a scene. An effect is a struct of parameters in SI units, without sizes. Its class template
// `bound<shape>` may have a state: the properties of one sensor, and a memory of earlier frames.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace random_purposes {
inline constexpr random_purpose sensor{7}; ///< properties of one simulated sensor
inline constexpr random_purpose frame{8};  ///< random effects in one simulated frame
} // namespace random_purposes

namespace simulation {

/// The stages from the object to the file, in the order of physics. A scene lists its effects in this order;
/// within a stage, any order is valid.
enum class stage : std::uint8_t {
    contact,   ///< heights of the object become pressures on the surface
    pad,       ///< pressures on the surface become pressures on the film
    tactel,    ///< pressures on the film become one pressure per tactel
    film,      ///< response of the film: gain, linearity, memory, temperature
    circuit,   ///< readout: crosstalk, broken lines, noise, threshold, saturation
    converter, ///< pascals become counts
    storage,   ///< changes of counts: resolution, compression
};

/// The purpose of random numbers. Each effect draws from streams of its own, so that adding an effect to a
/// scene changes no numbers of the others. Your own effect declares its purpose by a name:
///
///     static constexpr auto purpose = effect_purpose::named("my_gripper/slip");
using effect_purpose = numbered_purpose<struct sensor_unit>;

/// One sensor of a make, whose individual properties are drawn from its number.
struct sensor_unit {
    std::uint64_t number = 1;

    [[nodiscard]] constexpr random_stream random(effect_purpose purpose) const {
        return {number, random_purposes::sensor, 0, purpose.number()};
    }
};

/// The sensor and the grid that an effect is bound to.
struct mounting {
    double cell = tekscan_6077::pitch; ///< metres from cell to cell
    sensor_unit unit{};
};

/// The time and conditions of one frame.
struct moment {
    std::uint64_t seed = 1;  ///< of the random numbers
    std::uint32_t frame = 0; ///< number, different for each frame of a seed
    double seconds = 0;      ///< since the start of the touch
    double celsius = 22;     ///< of the sensor

    [[nodiscard]] constexpr random_stream random(effect_purpose purpose) const {
        return {seed, random_purposes::frame, frame, purpose.number()};
    }
};

// In addition to `apply`, a bound effect may have `void reset()`, to forget earlier frames. An effect that
// does not depend on the sensor_unit may declare `same_in_every_sensor = true`, so that scene::use does not
// construct it again.

/// Values that an effect changes in place: pascals, or counts after the converter.
template <shape Shape>
using signal = tensor_view<float, Shape>;

/// A bound effect that changes a frame in place.
template <class Bound, shape Shape>
concept in_place_effect = requires(Bound bound, signal<Shape> values, const moment& now) {
    { bound.apply(values, now) } noexcept;
};
/// A bound effect whose result has another shape.
template <class Bound, shape From, shape To>
concept reshaping_effect =
    requires(Bound bound, tensor_view<const float, From> from, signal<To> to, const moment& now) {
        { bound.apply(from, to, now) } noexcept;
    };

/// An effect declares its stage.
template <class Effect>
concept placed_effect = requires {
    { Effect::place } -> std::convertible_to<stage>;
};
/// An effect has a class template `bound<shape>`.
template <class Effect>
concept bindable_effect = std::copyable<Effect> && requires {
    typename Effect::template bound<shape{2, 2}>;
};
/// An effect has a stage and a class template `bound<shape>`.
template <class Effect>
concept effect = placed_effect<Effect> && bindable_effect<Effect>;

/// The output shape of an effect: `Effect::output<Shape>` if declared, else the input shape. (In `apply`,
/// name that shape as tactel_average does: signal<output<Shape>> crashes GCC 12.)
template <class Effect, shape Shape>
[[nodiscard]] consteval shape output_shape() {
    if constexpr (requires { Effect::template output<Shape>; })
        return Effect::template output<Shape>;
    else
        return Shape;
}

/// Multiplies all values by one factor, for effects that change the whole film alike. A factor below zero or
/// NaN counts as zero, and a factor beyond the largest float as that, so that zeros stay zero.
template <shape Shape>
void scale(signal<Shape> values, double factor) noexcept {
    constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
    const auto kept = static_cast<float>(factor > 0 ? std::min(factor, most) : 0.0);
    for (std::size_t i = 0; i < Shape.size(); ++i)
        values.data()[i] *= kept;
}

} // namespace simulation
}} // namespace tactnet
