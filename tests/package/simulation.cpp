// What a designer of sensors writes first.

#include <tactnet/simulation.hpp>

using namespace tactnet::simulation;

int main() {
    scene<array<8, 12>, contact<winkler>, saturation, quantisation<8>> scene;
    const touch ball{{{rod::sphere({}, 0.02)}, {}}, {}, pressing::to_force(1)};
    decltype(scene)::frames result;
    simulate(scene, ball, {}, result);
    return result.contact.converged ? 0 : 1;
}
