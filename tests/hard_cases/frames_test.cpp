// Frames through whole networks, in batches as trained and in the deployed form. Networks are drawn by
// he_normal, their running moments are those of many frames. Every logit is held to the bound that the
// running error analysis of support/layers/deployment_bound.hpp gives for this network and this frame:
// absolute, since logits cancel. Behind many layers the worst case says nothing (4e8 for logits of 8); then
// the deviation that independent roundings have is smaller, and is the bound.

#include "plain_network.hpp"
#include "record.hpp"

#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>
#include <tactnet/training/initialise.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <deployment/deployed_network.hpp>
#include <limits>
#include <span>
#include <string>
#include <vector>

using namespace tactnet;
using hard_cases::outcome;

namespace {

struct named_frame {
    const char* name;
    std::vector<float> counts;
};

/// Counts that a broken or unusual sensor may give.
std::vector<named_frame> hard_frames(shape image) {
    const std::size_t size = image.size();
    std::vector<named_frame> frames{{"all zero", std::vector<float>(size, 0.0f)},
                                    {"all 255", std::vector<float>(size, 255.0f)},
                                    {"one tactel", std::vector<float>(size, 0.0f)},
                                    {"checkerboard", std::vector<float>(size)},
                                    {"a negative tactel", std::vector<float>(size, 20.0f)},
                                    {"±1e15", std::vector<float>(size)},
                                    {"±1e30", std::vector<float>(size)}};
    frames[2].counts[size / 2] = 255;
    frames[4].counts[size / 3] = -40;
    for (std::size_t i = 0; i < size; ++i) {
        const bool odd = (i / image.columns + i % image.columns) % 2 == 1;
        frames[3].counts[i] = odd ? 255.0f : 0.0f;
        frames[5].counts[i] = odd ? 1e15f : -1e15f;
        frames[6].counts[i] = odd ? 1e30f : -1e30f;
    }
    return frames;
}

/// A network as it might be after training, and what goes in front of it.
template <class Network>
struct subject {
    Network net;
    std::vector<float> mean;
    thread_pool threads{1};
    typename Network::workspace space;

    explicit subject(std::uint64_t seed) : mean(Network::input_shape.size(), 40.0f) {
        initialise(net, he_normal{}, seed);
        typename Network::input_batch in(16);
        typename Network::output_batch out(16);
        for (std::uint64_t step = 0; step < 40; ++step) {
            for (std::size_t s = 0; s < 16; ++s)
                in.set(s, tensor_view<const float, Network::input_shape>(
                              shifted(drawn_frame(step * 16 + s), mean).data()));
            net.prepare(threads, space);
            net.forward(threads, space, in.as_const(), out.view(), seed, static_cast<std::uint32_t>(step));
        }
        net.prepare(threads, space);
    }
    static std::vector<float> drawn_frame(std::uint64_t seed) {
        const auto counts = support::make_frame(Network::input_shape.size(), seed);
        return {counts.begin(), counts.end()};
    }
    static std::vector<float> shifted(std::vector<float> counts, const std::vector<float>& mean) {
        for (std::size_t i = 0; i < counts.size(); ++i)
            counts[i] -= mean[i];
        return counts;
    }
    /// Logits of a batch with this frame alone.
    std::vector<float> in_batch(const std::vector<float>& counts) {
        typename Network::input_batch in(1);
        typename Network::output_batch out(1);
        in.set(0, tensor_view<const float, Network::input_shape>(shifted(counts, mean).data()));
        net.logits(threads, space, in.as_const(), out.view());
        std::vector<float> logits(Network::outputs);
        for (std::size_t o = 0; o < logits.size(); ++o)
            logits[o] = out(0, o);
        return logits;
    }
};

std::vector<outcome> outcomes_of(const support::rounded_map& expected, const std::vector<float>& plain,
                                 const std::vector<float>& ours) {
    std::vector<outcome> all;
    for (std::size_t o = 0; o < expected.size(); ++o)
        all.push_back({expected[o].value, static_cast<double>(plain[o]), static_cast<double>(ours[o]),
                       std::min(expected[o].error, expected[o].deviation)});
    return all;
}

template <class Network>
void check_frames(const std::string& name) {
    subject<Network> trained(7);
    constexpr shape image = Network::input_shape;
    const auto folded = support::describe<Network>();
    const auto unfolded = hard_cases::as_trained(folded);
    const auto parameters = support::parameters_of(trained.net);
    const auto check = [&](const char* kind, const std::vector<float>& counts, const auto& fast) {
        const auto in = support::bounded_input(counts, trained.mean, 1);
        const std::vector<float> plain =
            hard_cases::plain_outputs(unfolded, parameters, subject<Network>::shifted(counts, trained.mean));
        const std::string title = name + ", " + kind;
        hard_cases::hold(
            "frames", title + ", batch", hard_cases::unit::absolute,
            outcomes_of(support::bounded_outputs(unfolded, parameters, in), plain, trained.in_batch(counts)));
        std::vector<float> out(Network::outputs, NAN);
        const auto status =
            fast(tensor_view<const float, image>(counts.data()), std::span<float, Network::outputs>(out));
        // Where a sum might leave the range of single precision, a deployed network says so.
        if (status == frame_status::not_finite && counts[0] == -1e30f)
            return hard_cases::tell("frames", title + ", deployed", static_cast<double>(plain[0]), true,
                                    "not_finite");
        CHECK(status == frame_status::recognised);
        hard_cases::hold("frames", title + ", deployed", hard_cases::unit::absolute,
                         outcomes_of(support::bounded_outputs(folded, parameters, in), plain, out));
    };
    const auto fast = deploy(trained.net, std::span<const float, image.size()>(trained.mean), 1.0f);
    for (const named_frame& frame : hard_frames(image))
        check(frame.name, frame.counts, fast);

    // NaN and infinity at the first, a middle and the last tactel; what no sum can hold. A plain ReLU, x > 0
    // ? x : 0, makes a zero of a NaN.
    for (const float broken : {NAN, INFINITY, -INFINITY, 1e38f}) {
        bool told = true, seen = true;
        double plain = 0;
        for (const std::size_t place : {std::size_t{0}, image.size() / 2, image.size() - 1}) {
            std::vector<float> counts(image.size(), 20.0f);
            counts[place] = broken;
            std::vector<float> out(Network::outputs);
            told &= fast(tensor_view<const float, image>(counts.data()),
                         std::span<float, Network::outputs>(out)) == frame_status::not_finite;
            bool any = false;
            for (const float logit : trained.in_batch(counts))
                any |= !std::isfinite(logit);
            seen &= any;
            plain = static_cast<double>(hard_cases::plain_outputs(
                unfolded, parameters, subject<Network>::shifted(counts, trained.mean))[0]);
        }
        const std::string what = std::isnan(broken)     ? "NaN at three places"
                                 : broken == 1e38f      ? "1e38 at three places"
                                 : std::signbit(broken) ? "−∞ at three places"
                                                        : "∞ at three places";
        hard_cases::tell("frames", name + ", " + what + ", deployed", plain, told, "not_finite");
        if (std::isnan(broken))
            hard_cases::tell("frames", name + ", " + what + ", batch", plain, seen,
                             "logits that are not finite");
    }

    // Denormal numbers go in as they are: 1 to 91 or 1400 times the smallest.
    std::fill(trained.mean.begin(), trained.mean.end(), 0.0f);
    std::vector<float> ramp(image.size());
    for (std::size_t i = 0; i < ramp.size(); ++i)
        ramp[i] = static_cast<float>(i + 1) * std::numeric_limits<float>::denorm_min();
    check("a ramp of denormals", ramp, deploy(trained.net));
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
