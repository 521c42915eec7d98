#pragma once

#include <tactnet/simulation/objects/drawing.hpp>

#include <algorithm>
#include <cstddef>

// Compact objects: balls, boxes, bottles, rocks.

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation::objects {

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
