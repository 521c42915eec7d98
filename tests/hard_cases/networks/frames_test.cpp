// Frames through whole networks, in batches as trained and in the deployed form, after a short training.
// Every logit is held to the bound that the running error analysis of support/layers/deployed_reference.hpp
// gives for this network and this frame: absolute, since logits cancel. Behind many layers the worst case
// says nothing (4e8 for logits of 8); then the deviation that independent roundings have is smaller, and is
// the bound.

#include "../hold.hpp"
#include "trained_subject.hpp"

#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

using namespace tactnet;
using hard_cases::outcome;

namespace {

std::vector<outcome> outcomes_of(const support::sample& expected, const std::vector<float>& ours) {
    std::vector<outcome> all;
    for (std::size_t o = 0; o < expected.size(); ++o)
        all.push_back({expected[o].value, static_cast<double>(ours[o]),
                       std::min(expected[o].error, expected[o].deviation)});
    return all;
}

template <class Network>
void check_frames(const std::string& name) {
    using subject = hard_cases::trained_subject<Network>;
    subject trained(7);
    constexpr shape image = Network::input_shape;
    const auto folded = support::describe<Network>();
    const auto unfolded = support::as_trained(folded);
    const auto parameters = support::parameters_of(trained.net);
    const auto check = [&](const char* kind, const std::vector<float>& counts, const auto& fast) {
        const auto in = support::bounded_input(counts, trained.mean, 1);
        const std::string title = name + ", " + kind;
        hard_cases::hold(
            title + ", batch", hard_cases::unit::absolute,
            outcomes_of(support::bounded_outputs(unfolded, parameters, in), trained.in_batch(counts)));
        std::vector<float> out(Network::outputs, NAN);
        const auto status = fast.infer(tensor_view<const float, image>(counts.data()),
                                       std::span<float, Network::outputs>(out));
        // Where a sum might leave the range of single precision, a deployed network says so.
        if (status == frame_status::not_finite && counts[0] == -1e30f)
            return;
        CHECK(status == frame_status::ok);
        hard_cases::hold(title + ", deployed", hard_cases::unit::absolute,
                         outcomes_of(support::bounded_outputs(folded, parameters, in), out));
    };
    const auto fast = deploy(trained.net, std::span<const float, image.size()>(trained.mean), 1.0f);
    for (const hard_cases::named_frame& frame : hard_cases::hard_frames(image))
        check(frame.name, frame.counts, fast);

    // A ReLU of x > 0 ? x : 0 would make a zero of a NaN. 1e38 is more than sums can hold.
    for (const hard_cases::broken_value& broken : hard_cases::broken_values())
        for (const std::vector<float>& counts : hard_cases::broken_frames(image, broken.value)) {
            INFO(name, ", ", broken.name);
            std::vector<float> out(Network::outputs);
            CHECK(fast.infer(tensor_view<const float, image>(counts.data()),
                             std::span<float, Network::outputs>(out)) == frame_status::not_finite);
            const std::vector<float> logits = trained.in_batch(counts);
            if (std::isnan(broken.value))
                CHECK_FALSE(std::ranges::all_of(logits, [](float x) { return std::isfinite(x); }));
        }

    // Denormal numbers go in as they are.
    std::fill(trained.mean.begin(), trained.mean.end(), 0.0f);
    check("a ramp of denormals", hard_cases::denormal_ramp(image), deploy(trained.net));
}

} // namespace

TEST_CASE("frames: TactNet-4, 7 × 13") {
    check_frames<tactnet4<shape{7, 13}, 22>>("TactNet-4, 7 × 13");
}
TEST_CASE("frames: economical TactNet-6, 7 × 13") {
    check_frames<tactnet6_economical<shape{7, 13}, 22>>("economical TactNet-6, 7 × 13");
}
TEST_CASE("frames: TactNet-6, 28 × 50") {
    check_frames<tactnet6<shape{28, 50}, 22>>("TactNet-6, 28 × 50");
}
TEST_CASE("frames: TactResNet, 7 × 13") {
    check_frames<tactresnet<shape{7, 13}, 22>>("TactResNet, 7 × 13");
}
