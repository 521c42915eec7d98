// The same frames through the same networks in 8 bits. Integers do not round: the logits must equal those of
// a reference in 64-bit integers, a bound of 0. The naive implementation sums pairs of byte products in 16
// bits, which saturate (255 × 127 twice is 64 770), and clamps counts to 0 … 255. The distance between 8-bit
// and exact logits, on frames unlike the calibration images, is recorded as a limit.

#include "../record.hpp"
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
using hard_cases::outcome;

namespace {

/// Counts as a plain implementation takes them: what is no number becomes 0.
std::vector<float> as_bytes(std::vector<float> counts) {
    for (float& count : counts)
        count = std::isnan(count) ? 0 : std::clamp(std::nearbyint(count), 0.0f, 255.0f);
    return counts;
}

double largest_distance(std::span<const float> found, const support::sample& exact) {
    double distance = 0, largest = 0;
    for (std::size_t o = 0; o < exact.size(); ++o) {
        distance = std::max(distance, std::abs(static_cast<double>(found[o]) - exact[o].value));
        largest = std::max(largest, std::abs(exact[o].value));
    }
    return distance / largest;
}

template <class Network>
void check_frames(const std::string& name) {
    using subject = hard_cases::trained_subject<Network>;
    using view = typename deployed<Network, eight_bit>::view_type;
    constexpr shape image = Network::input_shape;
    const subject trained(7);
    const auto description = support::describe<Network>();
    const auto parameters = support::parameters_of(trained.net);

    std::vector<float> touches;
    for (std::size_t i = 0; i < Network::outputs; ++i) {
        const std::vector<float> touch = subject::touch(i, 10'000 + i);
        touches.insert(touches.end(), touch.begin(), touch.end());
    }
    const auto fast = deploy<eight_bit>(trained.net, std::span<const float, image.size()>(trained.mean), 1.0f,
                                        std::span<const float>(touches));
    const auto plain_of = [&](const std::vector<float>& counts) {
        return support::reference_outputs<view, support::saturating_pairs>(
            fast.folded(), std::span<const float>(as_bytes(counts)));
    };

    std::vector<hard_cases::named_frame> frames = hard_cases::hard_frames(image);
    frames.push_back({"a ramp of denormals", hard_cases::denormal_ramp(image)});
    frames.push_back({"a touch", subject::touch(3, 20'000)});
    for (const auto& [kind, counts] : frames) {
        const std::string title = name + ", " + kind + ", 8 bits";
        const std::vector<float> plain = plain_of(counts);
        std::vector<float> out(Network::outputs, NAN);
        const auto status = fast.infer(tensor_view<const float, image>(counts.data()),
                                       std::span<float, Network::outputs>(out));
        if (std::abs(counts[0]) > 1e6f) { // beyond what words of 16 bits hold
            hard_cases::reported("frames in 8 bits", title, static_cast<double>(plain[0]),
                                 status == frame_status::not_finite, "not_finite");
            continue;
        }
        CHECK(status == frame_status::ok);
        const std::vector<float> exact =
            support::reference_outputs<view>(fast.folded(), std::span<const float>(counts));
        std::vector<outcome> outcomes;
        for (std::size_t o = 0; o < exact.size(); ++o)
            outcomes.push_back({static_cast<double>(exact[o]), static_cast<double>(plain[o]),
                                static_cast<double>(out[o]), 0});
        hard_cases::hold("frames in 8 bits", title, hard_cases::unit::absolute, outcomes);

        const auto logits = support::bounded_outputs(description, parameters,
                                                     support::bounded_input(counts, trained.mean, 1));
        hard_cases::limit("frames in 8 bits", name + ", " + kind, largest_distance(plain, logits),
                          largest_distance(out, logits), "largest error of a logit ÷ largest logit");
    }

    for (const hard_cases::broken_value& broken : hard_cases::broken_values()) {
        bool all_reported = true;
        double plain = 0;
        for (const std::vector<float>& counts : hard_cases::broken_frames(image, broken.value)) {
            std::vector<float> out(Network::outputs);
            all_reported &= fast.infer(tensor_view<const float, image>(counts.data()),
                                       std::span<float, Network::outputs>(out)) == frame_status::not_finite;
            plain = static_cast<double>(plain_of(counts)[0]);
        }
        hard_cases::reported("frames in 8 bits", name + ", " + broken.name + ", 8 bits", plain, all_reported,
                             "not_finite");
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
