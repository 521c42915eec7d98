// Numbers near the smallest normal one, 1.2e-38. A rounding below it loses 2^-150 at most, or 2^-126 where
// the program has made its processor flush denormal numbers to zero; both are in the bounds.

#include "../hold.hpp"

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/training/loss.hpp>
#include <tactnet/training/optimiser.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <deployment/deployed_network.hpp>
#include <limits>
#include <span>
#include <string>
#include <support/tolerance.hpp>
#include <vector>

#if defined(__SSE__)
#include <immintrin.h>
#endif

using namespace tactnet;
using hard_cases::hold;
using hard_cases::outcome;
using hard_cases::unit;

namespace {

/// Denormal numbers count as zero while this lives, where the processor can.
class flush_to_zero {
public:
#if defined(__SSE__)
    static constexpr bool available = true;
    flush_to_zero() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
    ~flush_to_zero() { _mm_setcsr(before_); }

private:
    unsigned before_;
#else
    static constexpr bool available = false;
#endif
};

using net = network<shape{7, 13, 1}, conv2d<8, 3>, relu, conv2d<8, 3>, relu, max_pool<2>, dense<5>>;

/// A network without offsets, so that small numbers stay small.
net small_network(float weights) {
    net n;
    support::fill(n, 11);
    n.for_each_parameter([&](const parameter& p, auto values) {
        for (float& value : values)
            value *= p.role == parameter_role::weight ? weights : 0;
    });
    return n;
}
std::vector<float> frame_of(float size) {
    support::numbers draw(3);
    std::vector<float> frame(net::input_shape.size());
    for (float& value : frame)
        value = draw.next(-size, size);
    return frame;
}

/// `lost` is what a rounding may lose below the smallest normal number: each of at most 9 · 8 + 3 in every
/// layer, which the layers after it make larger by the sum of their weights.
void check_network(const std::string& name, float weights, float size, bool flushed) {
    const net n = small_network(weights);
    const std::vector<float> frame = frame_of(size);
    const auto layers = support::describe<net>();
    const auto expected =
        support::bounded_outputs(layers, support::parameters_of(n), support::bounded_input(frame, {}, 1));
    std::vector<float> out(net::outputs);
    const auto fast = deploy(n);
    {
        const auto run = [&] {
            CHECK(fast.infer(tensor_view<const float, net::input_shape>(frame.data()),
                             std::span<float, net::outputs>(out)) == frame_status::ok);
        };
        if (flushed) {
            const flush_to_zero now;
            run();
        } else {
            run();
        }
    }
    double largest = 1;
    for (const float w : n.learnable_values())
        largest = std::max(largest, static_cast<double>(std::abs(w)));
    // 56 dense inputs, 72 taps: what is lost before a layer is at most that many times larger after it.
    const double lost = flushed ? 0x1p-126 * 3 * 75 * 72 * 56 * std::pow(largest, 3) * 1600 : 0;
    std::vector<outcome> all;
    for (std::size_t o = 0; o < out.size(); ++o)
        all.push_back({expected[o].value, static_cast<double>(out[o]), expected[o].error + lost});
    hold(name, unit::absolute, all);
}

/// Seconds of the fastest of some calls.
template <class Body>
double fastest(Body&& body) {
    double best = 1e9;
    for (int i = 0; i < 15; ++i) {
        const auto begin = std::chrono::steady_clock::now();
        for (int k = 0; k < 20; ++k)
            body();
        best =
            std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    return best;
}

} // namespace

TEST_CASE("deployed: activations near the smallest normal number") {
    check_network("activations of 1e-38", 1, 1e-38f, false);
    check_network("activations that shrink to 1e-45", 1e-2f, 1e-38f, false);
    check_network("weights of 1e-38, frames of 1e38", 1e-20f, 1e15f, false);
    if (flush_to_zero::available) {
        check_network("activations of 1e-38, flush-to-zero", 1, 1e-38f, true);
        check_network("activations that shrink to 1e-45, flush-to-zero", 1e-2f, 1e-38f, true);
    }
}

// Gradients that underflow leave no trace in either moment that a step could show: AdamW's epsilon is 1e-8.
TEST_CASE("adamw: gradients near the smallest normal number, and moments that fade") {
    constexpr std::size_t size = 4096;
    optimiser_state<float> state;
    state.resize(size);
    aligned_vector<float> values(size, 1.0f), gradients(size, 1e-38f), decayed(size);
    optimiser_step<float>(adamw{.decay = 0}, state, 0.01, values, gradients, decayed);
    // The step is rate · g ÷ (|g| + 1e-8): 1e-32, far below half a unit of the value.
    hold("AdamW, gradients of 1e-38", unit::ulp, {1 - 1e-32, static_cast<double>(values[0]), 0.5});
    const auto time_of_step = [&] {
        return fastest(
            [&] { optimiser_step<float>(adamw{.decay = 0}, state, 0.01, values, gradients, decayed); });
    };
    std::fill(gradients.begin(), gradients.end(), 1e-3f);
    const double usual = time_of_step();
    // Without gradients the moments fade: the first in 900 steps, the second in 9000.
    std::fill(gradients.begin(), gradients.end(), 0.0f);
    for (int step = 0; step < 12'000; ++step)
        optimiser_step<float>(adamw{.decay = 0}, state, 0.01, values, gradients, decayed);
    // Times of a machine that does other things too: 3 times as long is no more than that, denormals cost 10
    // to 100.
    CHECK(time_of_step() / usual <= 3);
    CHECK(state.first[0] == 0);
    CHECK(state.second[0] == 0x1p-116f);
}

// What a softmax gives to classes out of reach is rounded to denormals or zero; a gradient is off by that.
TEST_CASE("softmax_cross_entropy: gradients that underflow") {
    using logits_of = batch<float, shape{1, 1, 2}, kernels::lanes<float>>;
    for (const float distance : {90.0f, 103.0f, 110.0f}) {
        logits_of in(1), gradient(1);
        in(0, 0) = distance;
        const std::vector<std::size_t> labels{0};
        static_cast<void>(softmax_cross_entropy(in.as_const(), std::span<const std::size_t>(labels), 2, 0.0,
                                                gradient.view()));
        const double exact = std::exp(-static_cast<double>(distance));
        hold("gradient of e^-" + std::to_string(static_cast<int>(distance)), unit::absolute,
             {exact, static_cast<double>(gradient(0, 1)), 0x1p-150 + 0x1p-24 * exact});
    }
}
