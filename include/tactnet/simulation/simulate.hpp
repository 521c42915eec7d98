#pragma once

#include <tactnet/simulation/objects/object.hpp>
#include <tactnet/simulation/scene.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace simulation {

/// One frame of a touch through a scene, with the memory that the scene has of earlier frames.
template <class Scene>
void simulate(Scene& scene, const touch& some, const moment& now, typename Scene::frames& result) {
    tensor<float, Scene::surface> heights;
    lay<Scene::surface>(some.shape, some.at, scene.cell(), heights.view());
    scene.touch(heights.view(), some.press, now, result);
}

} // namespace simulation
} // namespace TACTNET_ARCH
} // namespace tactnet
