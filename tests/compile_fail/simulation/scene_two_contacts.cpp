// expect: scene: the first effect, and no other, must be a contact
// at-most: 1
#include <tactnet/simulation.hpp>

using namespace tactnet::simulation;
scene<array<8, 12>, contact<winkler>, contact<bonded_layer>, noise> touched;
