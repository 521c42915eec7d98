// expect: effects must be listed in the order of physics: contact, pad, tactel, film, circuit, converter, storage
// expect: An analogue effect cannot follow the converter
// at-most: 1
#include <tactnet/simulation.hpp>

using namespace tactnet::simulation;
scene<array<8, 12>, contact<winkler>, quantisation<8>, noise> touched;
