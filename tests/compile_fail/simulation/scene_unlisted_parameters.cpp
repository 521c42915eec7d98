// expect: scene: parameters were given for an effect that is not listed, or is listed twice
// at-most: 1
#include <tactnet/simulation.hpp>

using namespace tactnet::simulation;
scene<array<8, 12>, contact<winkler>, noise> touched({}, {}, saturation{});
