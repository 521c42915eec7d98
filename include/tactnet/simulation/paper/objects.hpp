#pragma once

#include <tactnet/simulation/objects/family.hpp>
#include <tactnet/simulation/paper/bars.hpp>
#include <tactnet/simulation/paper/bodies.hpp>
#include <tactnet/simulation/paper/solids.hpp>
#include <tactnet/simulation/paper/tools.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace simulation {

/// The 22 classes of the paper, in the order of their names.
inline constexpr std::array<object_family, 22> paper_objects{{
    {"adhesive", objects::adhesive},
    {"allen_key", objects::allen_key},
    {"arm", objects::arm},
    {"ball", objects::ball},
    {"bottle", objects::bottle},
    {"box", objects::box},
    {"branch", objects::branch},
    {"cable", objects::cable},
    {"cable_pipe", objects::cable_pipe},
    {"caliper", objects::caliper},
    {"can", objects::can},
    {"finger", objects::finger},
    {"hand", objects::hand},
    {"highlighter", objects::highlighter},
    {"key", objects::key},
    {"pen", objects::pen},
    {"pliers", objects::pliers},
    {"rock", objects::rock},
    {"rubber", objects::rubber},
    {"scissors", objects::scissors},
    {"sticky_tape", objects::sticky_tape},
    {"tube", objects::tube},
}};

/// Touch `number` of a class, which is an index of paper_objects: the same wherever it is drawn.
[[nodiscard]] inline touch draw_touch(std::size_t label, std::uint64_t seed, std::uint32_t number) {
    enum what : std::uint32_t { shape = 4, pose = 5, force = 6 }; // of 64 for each class
    const auto stream = [&](what drawn) {
        return random_stream(seed, random_purposes::touch, number,
                             static_cast<std::uint32_t>(label) * 64 + drawn);
    };
    drawing draw(stream(shape), stream(pose), stream(force));
    return paper_objects.at(label).draw(draw);
}

} // namespace simulation
} // namespace TACTNET_ARCH
} // namespace tactnet
