#pragma once

#include <tactnet/simulation/objects/object.hpp>

#include <algorithm>
#include <cstddef>

// Parts of the human body, which are soft, with wide and faint contacts. Their moduli are of the order
// measured for the soft tissue of arms (10 to 50 kPa).

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation::objects {

[[nodiscard]] inline touch arm(drawing& draw) {
    const double radius = draw.within(38, 60) * mm, taper = draw.within(-0.2, 0.2);
    object shape;
    shape.parts.push_back(rod{{-beyond, 0}, {beyond, 0}, radius * (1 - taper), radius * (1 + taper)});
    shape.surface = draw.rough(2 * mm, 9 * mm);
    return {shape, draw.somewhere({{0, 0}, {30 * mm, 9 * mm}, 0, 180 * degrees, 1.5e-2}),
            soft(draw.pressed(7, 12), 15e3, 25 * mm)};
}

/// Two to four fingers side by side, each of three limbs.
[[nodiscard]] inline touch finger(drawing& draw) {
    object shape;
    const std::size_t fingers = draw.count(2, 4);
    const double pitch = draw.within(17, 22) * mm, fan = draw.around(4, 6) * degrees;
    for (std::size_t f = 0; f < fingers; ++f) {
        const double row = static_cast<double>(f) - (static_cast<double>(fingers) - 1) / 2;
        const point along = point::at_angle(row * fan);
        point at = point{draw.around(0, 7) * mm, row * pitch} - 30 * mm * along;
        const double bone = draw.within(0, 1.5) * mm;
        for (int limb = 0; limb < 3; ++limb) {
            const double length = draw.within(15, 24) * mm, radius = draw.within(6, 8.5) * mm;
            const double lift = bone + draw.within(0, 1.2) * mm;
            shape.parts.push_back(rod{at, at + (0.8 * length) * along, radius, 0.9 * radius, lift, lift});
            at = at + length * along;
            if (draw.chance(0.25)) // a joint
                shape.parts.push_back(rod::sphere(at - 2 * mm * along, 6 * mm, draw.within(0, 1) * mm));
        }
    }
    shape.surface = draw.rough(1 * mm, 7 * mm);
    return {shape, draw.somewhere({{0, 0}, {26 * mm, 12 * mm}, 0, 360 * degrees, 1.5e-2}),
            soft(draw.pressed(2.6, 5), 15e3, 8 * mm)};
}

/// A palm: a ring of muscles around a hollow.
[[nodiscard]] inline touch hand(drawing& draw) {
    object shape;
    const double radius = draw.within(32, 42) * mm, opening = draw.within(0, 120) * degrees;
    const double begin = draw.within(0, 360) * degrees;
    constexpr int pieces = 6;
    for (int piece = 0; piece < pieces; ++piece) {
        const double sweep = (360 * degrees - opening) / pieces, from = begin + piece * sweep;
        shape.parts.push_back(arc{{draw.around(0, 4) * mm, draw.around(0, 4) * mm},
                                  radius * draw.within(0.9, 1.15),
                                  draw.within(18, 30) * mm,
                                  from,
                                  from + sweep,
                                  draw.within(0, 3) * mm,
                                  draw.within(0, 3) * mm});
    }
    shape.surface = draw.rough(1.6 * mm, 9 * mm);
    return {shape, draw.somewhere({{0, 0}, {20 * mm, 9 * mm}, 0, 360 * degrees, 2e-2}),
            soft(draw.pressed(4.4, 8.7), 12e3, 22 * mm)};
}

// Compact objects: balls, boxes, bottles, rocks.

[[nodiscard]] inline touch ball(drawing& draw) {
    return {{{rod::sphere({}, draw.within(18, 32) * mm)}, {}},
            draw.somewhere({{0, 0}, {38 * mm, 18 * mm}, 0, 0, 1e-3}),
            draw.pressed(1.25, 2.7)};
}

/// A ribbed bottle: a row of bulges, some of them dented.
[[nodiscard]] inline touch bottle(drawing& draw) {
    const double pitch = draw.within(14, 19) * mm, bow = draw.around(0, 3e-3),
                 start = draw.within(0, 1) * pitch;
    const double half_width = draw.within(9.5, 13) * mm, half_length = draw.within(6, 8) * mm;
    const bool dented = draw.chance(0.5);
    object shape;
    for (int rib = -5; rib <= 5; ++rib) {
        const double along = rib * pitch + start, size = draw.within(0.85, 1.1);
        plate bulge{.centre = {along, bow * along * along / mm + draw.around(0, 1.5) * mm},
                    .half_length = half_length * draw.within(0.9, 1.1),
                    .half_width = half_width * size};
        bulge.corner = 0.95 * std::min(bulge.half_length, bulge.half_width);
        bulge.rim = 4 * mm;
        bulge.hollow = dented && draw.chance(0.7) ? draw.within(0.3, 0.8) * mm : 0;
        bulge.hollow_width = draw.within(4, 6) * mm;
        bulge.lift = draw.within(0, 0.3) * mm;
        shape.parts.push_back(bulge);
    }
    shape.surface = draw.rough(0.6 * mm, 5 * mm);
    return {shape, draw.somewhere({{0, 0}, {28 * mm, 4 * mm}, 65 * degrees, 120 * degrees, 5e-3}),
            draw.pressed(11, 17.5)};
}

/// A carton: its edges are stiff, its sides yield.
[[nodiscard]] inline touch box(drawing& draw) {
    const double half_width = draw.within(10.5, 14) * mm, length = draw.within(50, 110) * mm;
    object shape;
    shape.parts.push_back(plate{.centre = {length / 2, 0},
                                .half_length = length / 2,
                                .half_width = half_width,
                                .corner = 2 * mm,
                                .rim = draw.within(1.5, 3) * mm,
                                .hollow = draw.within(0.3, 0.75) * mm,
                                .hollow_width = draw.within(5, 8) * mm});
    shape.surface = draw.rough(0.2 * mm, 7 * mm);
    return {shape, draw.somewhere({{0, 0}, {26 * mm, 8 * mm}, 0, 360 * degrees, 5e-3}, {12 * mm, 0}),
            draw.pressed(7, 15.5)};
}

/// The protruding bumps of a stone.
[[nodiscard]] inline touch rock(drawing& draw) {
    object shape;
    const std::size_t blobs = draw.count(3, 6);
    const double radius = draw.within(10, 17) * mm;
    double angle = draw.within(0, 360) * degrees;
    for (std::size_t blob = 0; blob < blobs; ++blob) {
        const point centre = radius * draw.within(0.75, 1.25) * point::at_angle(angle);
        const point along = draw.within(0, 3) * mm * point::at_angle(draw.within(0, 360) * degrees);
        const double size = draw.within(4, 10) * mm, lift = draw.within(0, 0.6) * mm;
        shape.parts.push_back(
            rod{centre - along, centre + along, size, size * draw.within(0.7, 1.2), lift, lift});
        angle += draw.within(35, 75) * degrees;
    }
    return {shape, draw.somewhere({{0, 0}, {30 * mm, 10 * mm}, 0, 360 * degrees, 8e-3}),
            draw.pressed(8, 13.5)};
}

/// A flat square eraser, soft.
[[nodiscard]] inline touch rubber(drawing& draw) {
    const double half = draw.within(11.5, 14) * mm;
    object shape;
    shape.parts.push_back(plate{.centre = {},
                                .half_length = half,
                                .half_width = half * draw.within(0.92, 1.08),
                                .corner = draw.within(2, 5) * mm,
                                .rim = draw.within(1, 3) * mm});
    shape.surface = draw.rough(0.1 * mm, 5 * mm);
    return {shape, draw.somewhere({{0, 0}, {30 * mm, 12 * mm}, 0, 90 * degrees, 2e-3}),
            soft(draw.pressed(7.5, 21), 2e6, 20 * mm)};
}

}}} // namespace tactnet::simulation::objects
