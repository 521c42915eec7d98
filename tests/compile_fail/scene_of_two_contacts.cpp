// expect: scene: the first effect, and no other, must be a contact
// at-most: 1
#include <tactnet/simulation/scene.hpp>
#include <tactnet/simulation/winkler.hpp>

using namespace tactnet::simulation;
constexpr auto output = scene<array<28, 50>, contact<winkler>, contact<winkler>>::output;
