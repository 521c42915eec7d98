#pragma once

#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <variant>
#include <vector>

// Objects are made of simple bodies that lie on a plane. Only their undersides matter: the height of each
// point above the plane. Lengths are in metres, angles in radians.

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// x along the columns of the array, y along its rows.
struct point {
    double x = 0, y = 0;

    friend constexpr point operator+(point a, point b) { return {a.x + b.x, a.y + b.y}; }
    friend constexpr point operator-(point a, point b) { return {a.x - b.x, a.y - b.y}; }
    friend constexpr point operator*(double scale, point a) { return {scale * a.x, scale * a.y}; }
    [[nodiscard]] static point at_angle(double angle) { return {std::cos(angle), std::sin(angle)}; }
    [[nodiscard]] constexpr double dot(point other) const { return x * other.x + y * other.y; }
    [[nodiscard]] double length() const { return std::sqrt(dot(*this)); }
    /// Rotates about the origin, from x towards y.
    [[nodiscard]] point turned(double angle) const {
        const point axis = at_angle(angle);
        return {axis.x * x - axis.y * y, axis.y * x + axis.x * y};
    }
};

/// The height where there is no object.
inline constexpr double nothing = std::numeric_limits<double>::infinity();

namespace detail {

/// The underside of a round section with its lowest point at zero.
[[nodiscard]] inline double round_section(double radius, double distance) {
    return distance < radius
               ? distance * distance / (radius + std::sqrt(radius * radius - distance * distance))
               : nothing;
}

} // namespace detail

/// A round bar with round ends between two points: a cylinder, a cone if the radii differ, a sphere if the
/// points are equal. Its lowest line runs from one lift to the other.
struct rod {
    point from, to;
    double from_radius, to_radius;
    double from_lift = 0, to_lift = 0;

    [[nodiscard]] static rod sphere(point centre, double radius, double lift = 0) {
        return {centre, centre, radius, radius, lift, lift};
    }
    [[nodiscard]] double height(point place) const {
        const point along = to - from;
        const double square = along.dot(along);
        const double share = square > 0 ? std::clamp((place - from).dot(along) / square, 0.0, 1.0) : 0;
        const double radius = std::lerp(from_radius, to_radius, share);
        return std::lerp(from_lift, to_lift, share) +
               detail::round_section(radius, (place - (from + share * along)).length());
    }
};

/// A round bar bent to a circular arc, from one angle to the other in the direction of x towards y: from 350°
/// to 10° it is short. Angles a turn or more apart are the whole circle, equal angles a ball.
struct arc {
    point centre;
    double radius;    ///< of the circle
    double thickness; ///< radius of the bar
    double from_angle = 0, to_angle = 2 * std::numbers::pi;
    double from_lift = 0, to_lift = 0;

    [[nodiscard]] double height(point place) const {
        const point offset = place - centre;
        const double apart = to_angle - from_angle;
        const double sweep = apart >= 0 ? std::min(apart, turn) : within_a_turn(apart);
        const double angle = within_a_turn(std::atan2(offset.y, offset.x) - from_angle);
        if (angle <= sweep && sweep > 0)
            return std::lerp(from_lift, to_lift, angle / sweep) +
                   detail::round_section(thickness, std::abs(offset.length() - radius));
        const auto end = [&](double at, double lift) {
            return lift + detail::round_section(thickness, (offset - radius * point::at_angle(at)).length());
        };
        return std::min(end(from_angle, from_lift), end(to_angle, to_lift));
    }

private:
    static constexpr double turn = 2 * std::numbers::pi;
    static double within_a_turn(double angle) { return angle - turn * std::floor(angle / turn); }
};

/// A flat face with rounded corners: a box, or a disc if the corners cover it. The rim may be rounded, and
/// the inside hollow.
struct plate {
    point centre;
    double half_length, half_width;
    double angle = 0;        ///< from x to its length
    double corner = 0;       ///< radius in the plane, at most the smaller half size
    double rim = 0;          ///< radius of its lower edge
    double hollow = 0;       ///< height of the inside above the edge
    double hollow_width = 1; ///< distance of the inside from the edge
    double lift = 0;

    [[nodiscard]] static plate disc(point centre, double radius, double rim = 0, double lift = 0) {
        return {.centre = centre,
                .half_length = radius,
                .half_width = radius,
                .corner = radius,
                .rim = rim,
                .lift = lift};
    }
    [[nodiscard]] double height(point place) const {
        const point own = (place - centre).turned(-angle);
        const double round = std::min(corner, std::min(half_length, half_width));
        const point beyond{std::abs(own.x) - (half_length - round), std::abs(own.y) - (half_width - round)};
        const point outside{std::max(beyond.x, 0.0), std::max(beyond.y, 0.0)};
        // The distance from the outline.
        const double depth = round - outside.length() - std::min(std::max(beyond.x, beyond.y), 0.0);
        if (!(depth > 0))
            return nothing;
        const double edge = depth < rim ? detail::round_section(rim, rim - depth) : 0;
        const double share = std::clamp(depth / hollow_width, 0.0, 1.0);
        return lift + edge + hollow * share * share * (3 - 2 * share);
    }
};

/// A height map, for example from an image: rows × columns of heights, `cell` apart, with bilinear
/// interpolation. Each height represents a cell, so that the outermost ones extend half a cell further, and a
/// single row is a strip.
struct relief {
    point centre;
    std::size_t rows, columns;
    double cell;
    std::vector<float> heights; ///< row by row; infinite where there is no object
    double lift = 0;

    /// Throws std::invalid_argument if the number of heights is not rows × columns.
    [[nodiscard]] double height(point place) const {
        if (heights.size() != rows * columns)
            tactnet::detail::throw_invalid_argument(
                {"relief: expected ", rows, " x ", columns, " heights, found ", heights.size()});
        const double last_row = static_cast<double>(rows) - 1, last_column = static_cast<double>(columns) - 1;
        double row = (place.y - centre.y) / cell + last_row / 2,
               column = (place.x - centre.x) / cell + last_column / 2;
        if (!(row >= -0.5 && column >= -0.5 && row < last_row + 0.5 && column < last_column + 0.5))
            return nothing;
        row = std::clamp(row, 0.0, last_row), column = std::clamp(column, 0.0, last_column);
        const auto top = static_cast<std::size_t>(row), left = static_cast<std::size_t>(column);
        const std::size_t bottom = std::min(top + 1, rows - 1), right = std::min(left + 1, columns - 1);
        const auto at = [&](std::size_t r, std::size_t c) {
            return static_cast<double>(heights[r * columns + c]);
        };
        const double down = row - static_cast<double>(top), along = column - static_cast<double>(left);
        // Unlike std::lerp, an infinite height has no influence at a weight of zero.
        const auto mix = [](double a, double b, double share) {
            if (!(share > 0))
                return a;
            return a < nothing && b < nothing ? a + share * (b - a) : nothing;
        };
        return lift + mix(mix(at(top, left), at(top, right), along),
                          mix(at(bottom, left), at(bottom, right), along), down);
    }
};

/// A part of an object.
using part = std::variant<rod, arc, plate, relief>;

/// The height of a part at a place.
[[nodiscard]] inline double height(const part& body, point place) {
    return std::visit([&](const auto& some) { return some.height(place); }, body);
}

}}} // namespace tactnet::simulation
