#pragma once

#include <tactnet/simulation/objects/object.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

// Tools and stationery.

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation::objects {

/// The sharp jaws of a caliper, and its beam, which is higher.
[[nodiscard]] inline touch caliper(drawing& draw) {
    object shape;
    const double side = draw.sign();
    const double beam = draw.within(18, 34) * mm, beam_lift = draw.within(0.1, 0.75) * mm,
                 beam_half = draw.within(3.5, 5.5) * mm;
    shape.parts.push_back(plate{.centre = {draw.around(0, 10) * mm, 0},
                                .half_length = beam,
                                .half_width = beam_half,
                                .corner = 1.5 * mm,
                                .rim = 2 * mm,
                                .lift = beam_lift});
    const double gap = draw.within(10, 24) * mm, begin = beam_half + draw.within(-3, 6) * mm;
    const auto jaw = [&](double x, double lift) {
        const double length = draw.within(7, 22) * mm, thick = draw.within(3, 5) * mm;
        const double lean = draw.around(0, 3) * mm;
        add_bar(shape.parts,
                std::array{bend{{x, side * begin}, thick, lift}, bend{{x + lean, side * (begin + length)},
                                                                      draw.within(1.2, 2.5) * mm,
                                                                      lift + draw.within(0.1, 0.6) * mm}});
    };
    jaw(0, 0);
    jaw(draw.sign() * gap, draw.within(0.1, 0.7) * mm);
    shape.surface = draw.rough(0.2 * mm, 5 * mm);
    return {shape, draw.somewhere({{0, 0}, {22 * mm, 14 * mm}, -60 * degrees, 60 * degrees, 8e-3}),
            draw.pressed(7, 12.5)};
}

/// A flat barrel with one end on the array.
[[nodiscard]] inline touch highlighter(drawing& draw) {
    const double half_width = draw.within(7, 10.5) * mm, length = draw.within(34, 100) * mm;
    object shape;
    shape.parts.push_back(plate{.centre = {length / 2, 0},
                                .half_length = length / 2,
                                .half_width = half_width,
                                .corner = draw.within(1, 4) * mm,
                                .rim = draw.within(2, 5) * mm});
    shape.surface = draw.rough(0.15 * mm, 7 * mm);
    return {shape, draw.somewhere({{0, 0}, {28 * mm, 10 * mm}, 0, 360 * degrees, 4e-3}, {14 * mm, 0}),
            soft(draw.pressed(7, 14.5), 2e6, 20 * mm)};
}

/// A round bow and a flat blade.
[[nodiscard]] inline touch key(drawing& draw) {
    const double bow = draw.within(9, 13) * mm, blade = draw.within(20, 34) * mm,
                 half = draw.within(3.2, 5) * mm;
    object shape;
    plate head = plate::disc({}, bow, draw.within(1, 2.5) * mm, draw.within(0, 0.12) * mm);
    head.hollow = draw.chance(0.4) ? draw.within(0, 0.25) * mm : 0;
    head.hollow_width = draw.within(4, 7) * mm;
    shape.parts.push_back(head);
    shape.parts.push_back(plate{.centre = {bow + blade / 2 - 2 * mm, draw.around(0, 2) * mm},
                                .half_length = blade / 2 + 2 * mm,
                                .half_width = half,
                                .corner = draw.within(1, 3) * mm,
                                .rim = draw.within(1, 2.5) * mm,
                                .lift = draw.within(0, 0.12) * mm});
    shape.surface = draw.rough(0.12 * mm, 6 * mm);
    return {shape, draw.somewhere({{0, 0}, {22 * mm, 9 * mm}, 0, 360 * degrees, 4e-3}, {0.5 * blade, 0}),
            draw.pressed(4.4, 12.5)};
}

/// Two curved handles that meet at the joint, and the jaws, which are higher.
[[nodiscard]] inline touch pliers(drawing& draw) {
    object shape;
    const double opening = draw.within(22, 38), curve = draw.within(-14, 26),
                 length = draw.within(32, 55) * mm;
    const double radius = draw.within(2.6, 4) * mm;
    for (const double side : {-1.0, 1.0}) {
        std::vector<bend> bends;
        point at{};
        const double lift = draw.within(0, 0.25) * mm;
        constexpr int steps = 6;
        for (int step = 0; step <= steps; ++step) {
            const double share = static_cast<double>(step) / steps;
            bends.push_back({at, radius * (0.8 + 0.4 * std::sin(std::numbers::pi * share)),
                             lift + (step == steps ? 0.3 * mm : 0)});
            const double heading = side * (opening + curve * (0.5 - share) * 2) * degrees;
            at = at + length / steps * point::at_angle(heading);
        }
        add_bar(shape.parts, bends);
    }
    const double jaw = draw.within(14, 26) * mm;
    shape.parts.push_back(plate{.centre = {-jaw, draw.around(0, 2) * mm},
                                .half_length = 0.75 * jaw,
                                .half_width = draw.within(2.5, 5) * mm,
                                .corner = 2.4 * mm,
                                .rim = 2 * mm,
                                .lift = draw.within(0.25, 0.7) * mm});
    shape.surface = draw.rough(0.15 * mm, 5 * mm);
    const point between_handles{draw.within(0.1, 0.5) * length, 0};
    return {shape, draw.somewhere({{0, 0}, {22 * mm, 9 * mm}, 0, 360 * degrees, 7e-3}, between_handles),
            draw.pressed(6.2, 11.3)};
}

/// The two egg-shaped finger holes, side by side.
[[nodiscard]] inline touch scissors(drawing& draw) {
    object shape;
    const double longer = draw.within(24, 34) * mm, shorter = draw.within(11, 15) * mm,
                 radius = draw.within(2.4, 3.6) * mm;
    const double apart = shorter + draw.within(4, 9) * mm, spread = draw.around(0, 12) * degrees;
    for (const double side : {-1.0, 1.0}) {
        const double phase = draw.within(0, 360) * degrees, uneven = draw.within(0.1, 0.45) * mm;
        const double offset = draw.around(0, 6) * mm;
        std::vector<bend> bends;
        constexpr int steps = 20;
        for (int step = 0; step <= steps; ++step) {
            const double angle = 2 * std::numbers::pi * step / steps;
            const point egg{longer * std::cos(angle) + offset,
                            shorter * std::sin(angle) * (1 + 0.25 * std::cos(angle))};
            bends.push_back({egg.turned(side * spread) + point{0, side * apart}, radius,
                             uneven * (1 + std::cos(angle + phase)) / 2});
        }
        add_bar(shape.parts, bends);
    }
    const point one_of_them{0, draw.chance(0.6) ? apart : 0};
    return {shape, draw.somewhere({{0, 0}, {16 * mm, 10 * mm}, 0, 360 * degrees, 5e-3}, one_of_them),
            draw.pressed(7.7, 13.2)};
}

/// The rim of a roll of tape.
[[nodiscard]] inline touch sticky_tape(drawing& draw) {
    const double radius = draw.within(20, 27) * mm;
    object shape{{arc{{}, radius, draw.within(7, 14) * mm}}, {}};
    shape.surface = draw.rough(0.15 * mm, 6 * mm);
    return {shape, draw.somewhere({{0, 0}, {26 * mm, 7 * mm}, 0, 360 * degrees, 5e-3}),
            draw.pressed(7.4, 14.7)};
}

}}} // namespace tactnet::simulation::objects
