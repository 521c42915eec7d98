#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/simulation/paper/objects.hpp>
#include <tactnet/simulation/simulate.hpp>

#include <cstddef>
#include <cstdint>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace simulation {

/// Touch `number` of one of the paper's classes, on a sensor of its own: a network that learns from many
/// sensors of a make does not learn the flaws of one. Bit-exact wherever it is made.
template <class Scene>
void simulate_paper_touch(Scene& scene, std::size_t label, std::uint64_t seed, std::uint32_t number,
                          typename Scene::frames& result) {
    const auto mixed =
        philox({number, static_cast<std::uint32_t>(label), 0, random_purposes::sensor.number()},
               {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
    const std::uint64_t own = std::uint64_t{mixed[0]} << 32 | mixed[1];
    scene.use(sensor_unit{own});
    simulate(scene, draw_touch(label, seed, number), {.seed = own, .frame = number}, result);
}

} // namespace simulation
} // namespace TACTNET_ARCH
} // namespace tactnet
