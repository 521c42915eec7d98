// A tiny network with known weights, deployed: what it must say is reckoned by hand.

#include <tactnet/tactnet.hpp>
#include <tactnet/version.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>

#if TACTNET_VERSION < 100
#error "TACTNET_VERSION is missing"
#endif

using net = tactnet::network<tactnet::shape{4, 6}, tactnet::conv2d<1, 3>, tactnet::relu, tactnet::max_pool<2>,
                             tactnet::dense<2>>;
static_assert(net::parameters == 9 + 1 + 2 * 6 + 2);

int main() {
    net network;
    network.for_each_parameter([](const tactnet::parameter&, std::span<float> values) {
        std::fill(values.begin(), values.end(), 0.0F);
        if (values.size() == 9)
            values[4] = 2; // the kernel's middle: every tactel twice
        else if (values.size() == 12)
            values[3] = values[6 + 5] =
                1; // the first output is the lower left window, the second the lower right
    });
    const auto deployed = tactnet::deploy(network);

    std::array<float, 4 * 6> frame{};
    frame[2 * 6 + 1] = 3; // the largest of its window of 2 × 2
    frame[3 * 6 + 0] = 1;
    frame[3 * 6 + 5] = 0.5F;
    std::array<float, 2> outputs{};
    if (deployed.infer(frame, outputs) != tactnet::frame_status::ok || outputs[0] != 6 || outputs[1] != 1) {
        std::printf("expected 6 and 1, found %g and %g\n", static_cast<double>(outputs[0]),
                    static_cast<double>(outputs[1]));
        return 1;
    }
    std::printf("tactnet %d.%d.%d recognises\n", TACTNET_VERSION_MAJOR, TACTNET_VERSION_MINOR,
                TACTNET_VERSION_PATCH);
}
