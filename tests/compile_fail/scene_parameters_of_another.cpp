// expect: scene: parameters were given for an effect that is not listed
#include <tactnet/simulation/noise.hpp>
#include <tactnet/simulation/saturation.hpp>
#include <tactnet/simulation/scene.hpp>
#include <tactnet/simulation/winkler.hpp>

using namespace tactnet::simulation;
const scene<array<28, 50>, contact<winkler>, saturation> touch({}, {}, noise{.additive = 5});
