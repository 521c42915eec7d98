// expect: scene: the first effect, and no other, must be a contact
// at-most: 1
#include <tactnet/simulation/noise.hpp>
#include <tactnet/simulation/scene.hpp>

using namespace tactnet::simulation;
constexpr auto output = scene<array<28, 50>, noise>::output;
