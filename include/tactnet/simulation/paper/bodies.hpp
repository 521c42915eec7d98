#pragma once

#include <tactnet/simulation/objects/drawing.hpp>

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

}}} // namespace tactnet::simulation::objects
