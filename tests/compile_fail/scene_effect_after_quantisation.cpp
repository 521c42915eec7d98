// expect: scene: effects must be listed in the order of physics: contact, pad, tactel, film, circuit, converter, storage
// at-most: 1
#include <tactnet/simulation/noise.hpp>
#include <tactnet/simulation/quantisation.hpp>
#include <tactnet/simulation/scene.hpp>
#include <tactnet/simulation/winkler.hpp>

using namespace tactnet::simulation;
constexpr auto output = scene<array<28, 50>, contact<winkler>, quantisation<8>, noise>::output;
