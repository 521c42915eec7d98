// A scene, compiled three times: without an effect, with the effect's header only, and with the effect in its
// list.
#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/simulation/effects/circuit/conversion.hpp>
#include <tactnet/simulation/scene.hpp>
#ifdef TACTNET_TEST_HEADER
#include TACTNET_TEST_HEADER
#endif
#ifndef TACTNET_TEST_EFFECT
#define TACTNET_TEST_EFFECT
#endif

using namespace tactnet::simulation;
using touched = scene<array<28, 50>, contact<winkler>, TACTNET_TEST_EFFECT saturation, quantisation<8>>;

extern const std::size_t bytes_of_scene;
const std::size_t bytes_of_scene = sizeof(touched);

touched make_scene();
touched make_scene() {
    return touched{};
}
void touch_once(touched& scene, const tactnet::tensor<float, touched::surface>& heights,
                touched::frames& result);
void touch_once(touched& scene, const tactnet::tensor<float, touched::surface>& heights,
                touched::frames& result) {
    scene.touch(heights, pressing::to_force(5), {}, result);
}
