// tactnet_own_effect: a ball rests on an array whose film leaks its charge. Exit status: 0 if the counts fall
// as they should, else 1.

#include "charge_leak.hpp"

#include <tactnet/simulation.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

int main() {
    using namespace tactnet::simulation;
    using leaking = scene<array<28, 50>, contact<winkler>, elastic_pad, charge_leak, quantisation<8>>;
    leaking scene({}, {}, charge_leak{.time_constant = 2.0});
    const touch ball{.shape = {{rod::sphere({}, 20 * mm)}}, .press = pressing::to_force(1)};

    leaking::frames frames;
    std::array<float, 3> highest{};
    for (std::size_t second = 0; second < highest.size(); ++second) {
        simulate(scene, ball, {.seconds = static_cast<double>(second)}, frames);
        highest[second] = *std::max_element(frames.measured.begin(), frames.measured.end());
        std::printf("after %zu s: at most %.0f counts\n", second, static_cast<double>(highest[second]));
    }
    // e^-½ a second, and half a count of rounding on both sides.
    const auto leaks = [](float from, float to) {
        return std::abs(to - from * std::exp(-0.5f)) <= 0.5f + 0.5f * std::exp(-0.5f);
    };
    return highest[0] > 0 && leaks(highest[0], highest[1]) && leaks(highest[1], highest[2]) ? 0 : 1;
}
