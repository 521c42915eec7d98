#pragma once

// An object of your own: a table fork, its tines down. Copy it, and change the parts. Lengths are metres
// (here millimetres times `mm`), x runs along the columns of the array, y along its rows.

#include <tactnet/simulation/objects/object.hpp>

/// Another fork, in another pose, pressed with another force, for each state of `random`.
inline tactnet::simulation::touch fork(tactnet::simulation::drawing& random) {
    using namespace tactnet::simulation;
    object body;
    const double gap = random.around(5.5, 0.5) * mm, length = random.within(38, 45) * mm;
    for (int tine = 0; tine < 4; ++tine) {
        const double y = (tine - 1.5) * gap;
        body.parts.push_back(rod{.from = {0, y},
                                 .to = {length, y},
                                 .from_radius = 1.5 * mm,
                                 .to_radius = 0.8 * mm,
                                 .to_lift = 0.5 * mm}); // the points bend up
    }
    // The handle leaves the array.
    body.parts.push_back(rod{.from = {0, 0}, .to = {-beyond, 0}, .from_radius = 6 * mm, .to_radius = 4 * mm});
    return {.shape = body,
            .at = random.somewhere({.middle = {}, .reach = {4 * mm, 4 * mm}}, {length / 2, 0}),
            .press = random.pressed(5, 20)};
}
