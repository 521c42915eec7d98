#pragma once

#include <tactnet/simulation/objects/object.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

// Long objects: bars, bent bars, cables.

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation::objects {

/// The mouth of a tube of adhesive: a hairpin with legs beyond the array.
[[nodiscard]] inline touch adhesive(drawing& draw) {
    const double opening = draw.within(20, 44) * degrees / 2, bow = draw.within(4, 8) * mm;
    const double radius = draw.within(3, 4.5) * mm, leg = draw.within(50, 70) * mm;
    object shape;
    const double begin = -180 * degrees + opening, end = -opening; // over the top: y points down
    shape.parts.push_back(arc{{}, bow, radius, begin, end});
    for (const double side : {-1.0, 1.0}) {
        const point start = bow * point::at_angle(side < 0 ? begin : end);
        const point along{side * std::sin(opening), std::cos(opening)};
        const point bulge = draw.within(0, 3) * mm * point{side, 0};
        const double faint = draw.chance(0.5) ? draw.within(0, 0.3) * mm : 0;
        add_bar(shape.parts,
                std::array{bend{start, radius, 0}, bend{start + 0.5 * leg * along + bulge, radius, faint},
                           bend{start + leg * along, radius, faint / 2}});
    }
    return {shape, draw.somewhere({{0, -14 * mm}, {28 * mm, 8 * mm}, -35 * degrees, 35 * degrees, 4e-3}),
            draw.pressed(8, 14.5)};
}

/// An L of hexagonal bar.
[[nodiscard]] inline touch allen_key(drawing& draw) {
    const double radius = draw.within(2, 3) * mm, bow = draw.within(2.5, 5) * mm, side = draw.sign();
    const double longer = draw.within(38, 75) * mm, shorter = draw.within(12, 19) * mm;
    const double far = draw.within(0, 0.25) * mm;
    object shape;
    std::vector<bend> bends{{{longer, 0}, radius, far}, {{bow, 0}, radius, 0}};
    for (const double angle : {30.0, 60.0}) // the bend
        bends.push_back(
            {{bow * (1 - std::sin(angle * degrees)), side * bow * (1 - std::cos(angle * degrees))},
             radius,
             0});
    bends.push_back({{0, side * bow}, radius, 0});
    bends.push_back({{draw.within(-2, 2) * mm, side * shorter}, radius, draw.within(0, 0.2) * mm});
    add_bar(shape.parts, bends);
    return {shape, draw.somewhere({{0, 0}, {26 * mm, 13 * mm}, 0, 360 * degrees, 3e-3}), draw.pressed(7, 13)};
}

/// A stick: it tapers, bends a little, and its bark is rough.
[[nodiscard]] inline touch branch(drawing& draw) {
    const double thick = draw.within(4, 7) * mm, thin = draw.within(1.5, 3.5) * mm,
                 length = draw.within(22, 52) * mm;
    const point middle{length * draw.within(0.35, 0.65), draw.around(0, 2) * mm};
    object shape;
    add_bar(shape.parts, std::array{bend{{0, 0}, thick, draw.within(0, 0.25) * mm},
                                    bend{middle, (thick + thin) / 2, draw.within(0, 0.1) * mm},
                                    bend{{length, 0}, thin, draw.within(0, 0.7) * mm}});
    if (draw.chance(0.4)) // where a twig was
        shape.parts.push_back(
            rod::sphere({middle.x, middle.y + draw.around(0, 2) * mm}, thick, draw.within(0, 0.2) * mm));
    shape.surface = draw.rough(0.25 * mm, 4 * mm);
    const double angle = 90 + draw.around(0, 55);
    pose at = draw.somewhere({{0, 0}, {36 * mm, 6 * mm}, 0, 0, 4e-3});
    at.angle = (draw.chance(0.5) ? angle : angle + 180) * degrees;
    at.position = at.position - 0.5 * length * point::at_angle(at.angle);
    return {shape, at, draw.pressed(10, 17)};
}

/// Turns of a coiled cable.
[[nodiscard]] inline touch cable(drawing& draw) {
    object shape;
    const std::size_t turns = draw.count(2, 4);
    double radius = draw.within(28, 50) * mm;
    for (std::size_t turn = 0; turn < turns; ++turn) {
        const point centre{draw.around(0, 5) * mm, draw.around(0, 5) * mm};
        const double lift = draw.within(0, 0.5) * mm;
        shape.parts.push_back(arc{centre, radius, draw.within(1.8, 3) * mm, 0, 360 * degrees, lift, lift});
        radius += draw.within(6, 20) * mm;
    }
    const point middle_turn{radius - draw.within(18, 30) * mm, 0};
    return {shape, draw.somewhere({{0, 0}, {20 * mm, 10 * mm}, 0, 360 * degrees, 5e-3}, middle_turn),
            draw.pressed(8, 17)};
}

/// A corrugated pipe: short bars across its axis.
[[nodiscard]] inline touch cable_pipe(drawing& draw) {
    const double pitch = draw.within(8, 10.5) * mm, half = draw.within(4, 6.5) * mm,
                 radius = draw.within(2.5, 3.6) * mm;
    const double bow = draw.around(0, 2.5e-3), lean = draw.around(0, 10) * degrees,
                 start = draw.within(0, 1) * pitch;
    object shape;
    for (int rib = -9; rib <= 9; ++rib) {
        const double along = rib * pitch + start;
        const point centre{along, bow * along * along / mm / 10};
        const point across = half * point::at_angle(90 * degrees + lean + 2 * bow * along / mm / 10);
        const double lift = draw.within(0, 0.25) * mm;
        shape.parts.push_back(rod{centre - across, centre + across, radius, radius, lift, lift});
    }
    return {shape, draw.somewhere({{0, 0}, {22 * mm, 6 * mm}, 35 * degrees, 150 * degrees, 6e-3}),
            draw.pressed(9.5, 15.5)};
}

namespace detail {

/// A straight bar across the whole array.
[[nodiscard]] inline touch straight(drawing& draw, double radius, double slope, pressing press) {
    object shape{{rod{{-beyond, 0}, {beyond, 0}, radius, radius}}, {}};
    return {std::move(shape), draw.somewhere({{0, 0}, {34 * mm, 10 * mm}, 0, 180 * degrees, slope}), press};
}

} // namespace detail

[[nodiscard]] inline touch can(drawing& draw) {
    return detail::straight(draw, draw.within(26, 36) * mm, 3e-3, draw.pressed(10, 18));
}
[[nodiscard]] inline touch pen(drawing& draw) {
    return detail::straight(draw, draw.within(4, 5.5) * mm, 1.5e-3, draw.pressed(3.3, 6.7));
}
[[nodiscard]] inline touch tube(drawing& draw) {
    return detail::straight(draw, draw.within(8, 12) * mm, 1.5e-3, draw.pressed(4.4, 7.8));
}

}}} // namespace tactnet::simulation::objects
