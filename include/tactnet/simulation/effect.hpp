#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/tensor/tensor_view.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>

// What an effect of a scene is. An effect is described without sizes, as a plain struct of parameters in SI
// units; bound to the shape of what reaches it, it may carry a state: what the sensor was made with, what it
// remembers of earlier frames.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace random_purposes {
inline constexpr random_purpose sensor{7}; ///< what a simulated sensor was made with
inline constexpr random_purpose frame{8};  ///< what befalls one simulated frame
} // namespace random_purposes

namespace simulation {

/// Where on the way from the object to the file an effect happens, in the order of physics. A scene lists its
/// effects in this order; within one stage any order is right.
enum class stage : std::uint8_t {
    contact,   ///< heights of the object become pressures on the surface
    pad,       ///< pressures on the surface become pressures on the film
    tactel,    ///< pressures on the film become one pressure a tactel
    film,      ///< how the film answers: gain, linearity, memory, temperature
    circuit,   ///< how it is read: crosstalk, broken lines, noise, threshold, saturation
    converter, ///< pascals become counts
    storage,   ///< what is done with counts: resolution, compression
};

/// Whose random numbers: each effect draws from streams of its own, so that a scene with one effect more
/// draws the same numbers for all others. An effect declares its purpose itself, your own by a name:
///
///     static constexpr auto purpose = effect_purpose::named("my_gripper/slip");
using effect_purpose = numbered_purpose<struct sensor_unit>;

/// One sensor of a make: what varies from one to the next is drawn from its number.
struct sensor_unit {
    std::uint64_t number = 1;

    [[nodiscard]] constexpr random_stream random(effect_purpose purpose) const {
        return {number, random_purposes::sensor, 0, purpose.number()};
    }
};

/// Where an effect is put: on which sensor, on a grid of what cells.
struct mounting {
    double cell = tekscan_6077::pitch; ///< metres from cell to cell
    sensor_unit unit{};
};

/// When and under what conditions one frame is taken.
struct moment {
    std::uint64_t seed = 1;  ///< of the random numbers
    std::uint32_t frame = 0; ///< frames of one seed have different numbers
    double seconds = 0;      ///< since the touch began
    double celsius = 22;     ///< of the sensor

    [[nodiscard]] constexpr random_stream random(effect_purpose purpose) const {
        return {seed, random_purposes::frame, frame, purpose.number()};
    }
};

// Beside `apply` an effect bound to a shape may have `void reset()`, to forget earlier frames. An effect that
// is long in the making and makes nothing of its sensor_unit says `same_in_every_sensor = true`: scene::use
// then leaves it in place.

/// Values that an effect may change in place: pascals, or counts from the converter on.
template <shape Shape>
using signal = tensor_view<float, Shape>;

/// What an effect bound to a shape does to one frame.
template <class Bound, shape Shape>
concept in_place_effect = requires(Bound bound, signal<Shape> values, const moment& now) {
    { bound.apply(values, now) }
    noexcept;
};
/// The same for one whose result has another shape.
template <class Bound, shape From, shape To>
concept reshaping_effect = requires(Bound bound, tensor_view<const float, From> from, signal<To> to,
                                    const moment& now) {
    { bound.apply(from, to, now) }
    noexcept;
};

/// What every effect has: a stage, and a form bound to a shape.
template <class Effect>
concept placed_effect = requires {
    { Effect::place } -> std::convertible_to<stage>;
};
template <class Effect>
concept bindable_effect = std::copyable<Effect> && requires {
    typename Effect::template bound<shape{2, 2}>;
};
template <class Effect>
concept effect = placed_effect<Effect> && bindable_effect<Effect>;

/// The shape of what an effect makes of a shape: `Effect::output<Shape>` if it says so, else the same. (In
/// `apply` give that shape a name of its own, as tactel_average does: signal<output<Shape>> crashes GCC 12.)
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
} // namespace TACTNET_ARCH
} // namespace tactnet
