#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/simulation/objects/object.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string_view>
#include <vector>

// Random objects and poses. Families of objects write lengths in millimetres and angles in degrees.

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// One millimetre in metres.
inline constexpr double mm = 1e-3;
/// One degree in radians.
inline constexpr double degrees = std::numbers::pi / 180;

/// The range of random poses: around a place, with any angle of a range.
struct pose_range {
    point middle;
    point reach; ///< largest distance from the middle, along x and y
    double from_angle = 0, to_angle = 2 * std::numbers::pi;
    double slope = 2e-3; ///< standard deviation of the tilt, in metres per metre
};

/// Draws random properties of objects, from separate streams for shape, pose and force.
class drawing {
public:
    drawing(random_stream shape, random_stream where, random_stream force)
        : shape_(shape), where_(where), force_(force) {}

    /// Draws uniformly between `low` and `high`, for the shape, as the members below do.
    [[nodiscard]] double within(double low, double high) { return shape_.uniform(low, high); }
    [[nodiscard]] double around(double middle, double spread) { return middle + spread * within(-1, 1); }
    [[nodiscard]] bool chance(double probability) { return shape_.uniform() < probability; }
    [[nodiscard]] double sign() { return chance(0.5) ? 1 : -1; }
    [[nodiscard]] std::size_t count(std::size_t least, std::size_t most) {
        return least + shape_.below(static_cast<std::uint32_t>(most - least + 1));
    }
    [[nodiscard]] roughness rough(double amplitude, double wavelength) {
        return {amplitude, wavelength, shape_.bits()};
    }

    /// Draws a pose of the range for the point `middle` of the object.
    [[nodiscard]] pose somewhere(const pose_range& range, point middle = {}) {
        pose at;
        at.position = range.middle +
                      point{where_.uniform(-1, 1) * range.reach.x, where_.uniform(-1, 1) * range.reach.y};
        at.angle = where_.uniform(range.from_angle, range.to_angle);
        at.slope = {range.slope * where_.normal(), range.slope * where_.normal()};
        at.position = at.position - middle.turned(at.angle);
        return at;
    }
    /// Draws a force, log-uniform in newtons.
    [[nodiscard]] pressing pressed(double least, double most) {
        return pressing::to_force(least * std::pow(most / least, force_.uniform()));
    }

private:
    random_stream shape_, where_, force_;
};

/// Makes the object of a pressing soft, with a modulus in pascals and a thickness in metres.
[[nodiscard]] inline pressing soft(pressing press, double modulus, double thickness) {
    press.object_modulus = modulus;
    press.object_thickness = thickness;
    return press;
}

/// A point of a bent bar.
struct bend {
    point at;
    double radius;
    double lift = 0;
};
/// Adds a bent bar: rods from point to point.
inline void add_bar(std::vector<part>& parts, std::span<const bend> bends) {
    for (std::size_t i = 1; i < bends.size(); ++i) {
        const bend &a = bends[i - 1], &b = bends[i];
        parts.push_back(rod{a.at, b.at, a.radius, b.radius, a.lift, b.lift});
    }
}

/// A length beyond any array, for parts that end outside of it.
inline constexpr double beyond = 150 * mm;

/// A kind of object. Each draw is another object of the kind, in another pose, pressed with another force.
struct object_family {
    std::string_view name;
    touch (*draw)(drawing&); ///< draws one at random
};

}}} // namespace tactnet::simulation
