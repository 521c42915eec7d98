// The same frames through the same networks in 8 bits. Integers do not round: the logits must equal those of
// a reference in 64-bit integers.

#include "trained_subject.hpp"

#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>
#include <tactnet/quantisation.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <support/layers/whole_reference.hpp>
#include <vector>

using namespace tactnet;

namespace {

template <class Network>
void check_frames(const std::string& name) {
    using subject = hard_cases::trained_subject<Network>;
    using view = typename deployed<Network, eight_bit>::view_type;
    constexpr shape image = Network::input_shape;
    const subject trained(7);

    std::vector<float> touches;
    for (std::size_t i = 0; i < Network::outputs; ++i) {
        const std::vector<float> touch = subject::touch(i, 10'000 + i);
        touches.insert(touches.end(), touch.begin(), touch.end());
    }
    const auto fast = deploy<eight_bit>(trained.net, std::span<const float, image.size()>(trained.mean), 1.0f,
                                        std::span<const float>(touches));
    std::vector<hard_cases::named_frame> frames = hard_cases::hard_frames(image);
    frames.push_back({"a ramp of denormals", hard_cases::denormal_ramp(image)});
    frames.push_back({"a touch", subject::touch(3, 20'000)});
    for (const auto& [kind, counts] : frames) {
        INFO(name, ", ", kind);
        std::vector<float> out(Network::outputs, NAN);
        const auto status = fast.infer(tensor_view<const float, image>(counts.data()),
                                       std::span<float, Network::outputs>(out));
        if (std::abs(counts[0]) > 1e6f) { // beyond what words of 16 bits hold
            CHECK(status == frame_status::not_finite);
            continue;
        }
        CHECK(status == frame_status::ok);
        CHECK(out == support::reference_outputs<view>(fast.folded(), std::span<const float>(counts)));
    }

    for (const hard_cases::broken_value& broken : hard_cases::broken_values())
        for (const std::vector<float>& counts : hard_cases::broken_frames(image, broken.value)) {
            INFO(name, ", ", broken.name);
            std::vector<float> out(Network::outputs);
            CHECK(fast.infer(tensor_view<const float, image>(counts.data()),
                             std::span<float, Network::outputs>(out)) == frame_status::not_finite);
        }
}

} // namespace

TEST_CASE("frames: TactNet-4, 7 × 13, in 8 bits") {
    check_frames<tactnet4<shape{7, 13}, 22>>("TactNet-4, 7 × 13");
}
TEST_CASE("frames: economical TactNet-6, 7 × 13, in 8 bits") {
    check_frames<tactnet6_economical<shape{7, 13}, 22>>("economical TactNet-6, 7 × 13");
}
TEST_CASE("frames: TactNet-6, 28 × 50, in 8 bits") {
    check_frames<tactnet6<shape{28, 50}, 22>>("TactNet-6, 28 × 50");
}
TEST_CASE("frames: TactResNet, 7 × 13, in 8 bits") {
    check_frames<tactresnet<shape{7, 13}, 22>>("TactResNet, 7 × 13");
}
