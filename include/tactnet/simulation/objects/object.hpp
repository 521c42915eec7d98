#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/simulation/objects/part.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace random_purposes {
inline constexpr random_purpose touch{9}; ///< the object and pose of a simulated touch
} // namespace random_purposes

namespace simulation {

/// Roughness of a surface: random heights at the points of a grid, with smooth interpolation.
struct roughness {
    double amplitude = 0;     ///< metres, the largest height; 0 or less is smooth
    double wavelength = 4e-3; ///< metres between points; 0 is smooth
    std::uint32_t seed = 0;

    [[nodiscard]] double height(point place) const {
        if (!(amplitude > 0))
            return 0;
        const double x = place.x / wavelength, y = place.y / wavelength;
        if (!(std::abs(x) < countable && std::abs(y) < countable))
            return 0;
        const double left = std::floor(x), top = std::floor(y);
        const auto at = [&](double column, double row) {
            const auto number = [](double n) {
                return static_cast<std::uint32_t>(static_cast<std::int64_t>(n));
            };
            return philox({number(left + column), number(top + row), 0, 0}, {seed, 0x726F7567})[0] * 0x1p-32;
        };
        const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
        const double along = smooth(x - left), down = smooth(y - top);
        return amplitude *
               std::lerp(std::lerp(at(0, 0), at(1, 0), along), std::lerp(at(0, 1), at(1, 1), along), down);
    }

private:
    static constexpr double countable = 0x1p53; // beyond this, grid points have no exact integers
};

/// The pose of an object: rotated about its origin, then moved from the middle of the array.
struct pose {
    point position{};
    double angle = 0;
    point slope{}; ///< rise of the object along x and y, in metres per metre
};

/// An object: at each place its lowest part counts.
struct object {
    std::vector<part> parts{};
    roughness surface{};

    [[nodiscard]] double height(point place) const {
        double lowest = nothing;
        for (const part& some : parts)
            lowest = std::min(lowest, simulation::height(some, place));
        return lowest < nothing ? lowest + surface.height(place) : nothing;
    }
};

/// An object about to touch an array.
struct touch {
    object shape{};
    pose at{};
    pressing press{};
};

/// Computes the heights of an object over the cells of an array, whose middle is the origin. `cell` is in
/// metres.
template <shape Shape>
void compute_heights(const object& body, const pose& at, double cell, signal<Shape> heights) {
    for (std::size_t row = 0; row < Shape.rows; ++row)
        for (std::size_t column = 0; column < Shape.columns; ++column) {
            const point place{(static_cast<double>(column) - (static_cast<double>(Shape.columns) - 1) / 2) *
                                  cell,
                              (static_cast<double>(row) - (static_cast<double>(Shape.rows) - 1) / 2) * cell};
            const point from_object = place - at.position;
            heights(row, column) =
                static_cast<float>(body.height(from_object.turned(-at.angle)) + at.slope.dot(from_object));
        }
}

/// Simulates one frame of a touch. Effects of the scene that have a memory continue from its last frame.
template <class Scene>
void simulate(Scene& scene, const touch& some, const moment& now, typename Scene::frames& result) {
    tensor<float, Scene::surface> heights;
    compute_heights<Scene::surface>(some.shape, some.at, scene.cell(), heights.view());
    scene.touch(heights.view(), some.press, now, result);
}

} // namespace simulation

}} // namespace tactnet

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
