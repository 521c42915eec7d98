#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/simulation/objects/part.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
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
