// Softmax with cross-entropy where exponentials leave the range of numbers. The loss is made in double from
// single precision logits: their distances from the largest are off by v = 2^-53 of them, an exponential by
// two units, a sum of C of them by γ(C), so that the loss is within (C + 8) v of itself and of the sum's
// logarithm. Gradients are rounded once to single precision. References are long doubles.

#include "hold.hpp"

#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/training/loss.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deployment/deployed_network.hpp>
#include <limits>
#include <span>
#include <string>
#include <vector>

using namespace tactnet;
using hard_cases::hold;
using hard_cases::outcome;
using hard_cases::unit;

namespace {

constexpr std::size_t classes = 22;
using logits_of = batch<float, shape{1, 1, classes}, kernels::lanes<float>>;

struct loss_and_gradient {
    double loss = 0;
    std::vector<double> gradient;
};

loss_and_gradient exact(const std::vector<float>& logits, std::size_t label, double smoothing) {
    const auto largest = static_cast<long double>(*std::ranges::max_element(logits));
    long double sum = 0, total = 0;
    for (const float x : logits)
        sum += std::exp(x - largest);
    loss_and_gradient result;
    for (std::size_t c = 0; c < logits.size(); ++c) {
        const long double log_probability = logits[c] - largest - std::log(sum);
        const long double wanted =
            static_cast<long double>(smoothing) / static_cast<long double>(logits.size()) +
            (c == label ? 1 - static_cast<long double>(smoothing) : 0.0L);
        if (wanted > 0)
            total -= wanted * log_probability;
        result.gradient.push_back(static_cast<double>(std::exp(log_probability) - wanted));
    }
    result.loss = static_cast<double>(total);
    return result;
}
void check_loss(const std::string& name, const std::vector<float>& logits, std::size_t label,
                double smoothing) {
    const loss_and_gradient expected = exact(logits, label, smoothing);
    logits_of in(1), gradient(1);
    for (std::size_t c = 0; c < classes; ++c)
        in(0, c) = logits[c];
    const std::vector<std::size_t> labels{label};
    const double loss = softmax_cross_entropy(in.as_const(), std::span<const std::size_t>(labels), classes,
                                              smoothing, gradient.view());
    const double v = 0x1p-53;
    hold(name, unit::absolute, {expected.loss, loss, (classes + 8) * v * (std::abs(expected.loss) + 4)});
    std::vector<outcome> all;
    for (std::size_t c = 0; c < classes; ++c)
        all.push_back(
            {expected.gradient[c], static_cast<double>(gradient(0, c)),
             support::unit_roundoff<float> * std::abs(expected.gradient[c]) + (classes + 8) * v + 0x1p-149});
    hold(name + ", gradient", unit::absolute, all);
}

std::vector<float> spread(float size) {
    std::vector<float> logits(classes);
    for (std::size_t c = 0; c < classes; ++c)
        logits[c] = size * (static_cast<float>(static_cast<int>(c * 7 % classes) - 10) / 11);
    return logits;
}

} // namespace

TEST_CASE("softmax_cross_entropy: logits of all sizes, smoothing from none to nearly all") {
    check_loss("logits within ±1e4", spread(1e4f), 3, 0);
    check_loss("logits within ±1e4, smoothing 0.1", spread(1e4f), 3, 0.1);
    check_loss("logits within ±3e38", spread(3e38f), 3, 0);
    check_loss("logits within ±3e38, smoothing 0.1", spread(3e38f), 3, 0.1);
    check_loss("all logits 0", std::vector<float>(classes), 3, 0);
    check_loss("all logits 3e38", std::vector<float>(classes, 3e38f), 3, 0.1);
    check_loss("logits within ±1e-40", spread(1e-40f), 3, 0);
    check_loss("smoothing 1", spread(5), 3, 1);
    std::vector<float> sure = spread(1);
    sure[3] = 60;
    check_loss("the correct class ahead by 60", sure, 3, 0);
    sure[3] = -300;
    check_loss("a probability of e^-300", sure, 3, 0);
}

namespace {

using two_layers = network<shape{1, 1, 4}, dense<classes>, softmax>;

/// Probabilities, as a batch and deployed: the bound of the running error analysis.
void check_softmax(const std::string& name, float size) {
    two_layers net;
    support::fill(net, 9);
    for (float& value : net.learnable_values())
        value *= size;
    const std::vector<float> in{1, -0.5f, 0.25f, 0.75f};
    const auto layers = support::describe<two_layers>();
    const auto expected =
        support::bounded_outputs(layers, support::parameters_of(net), support::bounded_input(in, {}, 1));
    std::vector<float> deployed_values(classes);
    CHECK(deploy(net).infer(tensor_view<const float, two_layers::input_shape>(in.data()),
                            std::span<float, classes>(deployed_values)) == frame_status::ok);
    thread_pool threads(1);
    two_layers::workspace space;
    two_layers::input_batch batch_in(1);
    two_layers::output_batch batch_out(1);
    batch_in.set(0, tensor_view<const float, two_layers::input_shape>(in.data()));
    net.prepare(threads, space);
    net.infer(batch_in.as_const(), batch_out.view(), threads, space);
    std::vector<outcome> of_batch, of_deployed;
    for (std::size_t c = 0; c < classes; ++c) {
        // A probability is never off by more than 1.
        const double bound = expected[c].error < 1 ? expected[c].error : 1.0;
        of_batch.push_back({expected[c].value, static_cast<double>(batch_out(0, c)), bound});
        of_deployed.push_back({expected[c].value, static_cast<double>(deployed_values[c]), bound});
    }
    hold("probabilities of " + name + ", batch", unit::absolute, of_batch);
    hold("probabilities of " + name + ", deployed", unit::absolute, of_deployed);
}

} // namespace

TEST_CASE("softmax: probabilities of large logits") {
    check_softmax("logits of 1", 1);
    check_softmax("logits of 100", 100);
    check_softmax("logits of 1e4", 1e4f);
    check_softmax("logits of 1e28", 1e28f);
}

// The class counts as any other: its gradient is its probability, which the images of the others push
// down.
TEST_CASE("softmax_cross_entropy: a class without images") {
    const std::size_t samples = 5;
    logits_of in(samples), gradient(samples);
    const std::vector<float> logits = spread(3);
    std::vector<std::size_t> labels;
    for (std::size_t s = 0; s < samples; ++s) {
        labels.push_back(s % 2);
        for (std::size_t c = 0; c < classes; ++c)
            in(s, c) = logits[c];
    }
    const double loss = softmax_cross_entropy(in.as_const(), std::span<const std::size_t>(labels), classes,
                                              0.0, gradient.view());
    const loss_and_gradient zero = exact(logits, 0, 0), one = exact(logits, 1, 0);
    hold("20 of 22 classes without images", unit::relative,
         {(3 * zero.loss + 2 * one.loss) / 5, loss, (classes + 16) * 0x1p-53});
    double sum = 0;
    for (std::size_t s = 0; s < samples; ++s)
        sum += static_cast<double>(gradient(s, 21));
    hold("20 of 22 classes without images, gradient of one logit", unit::relative,
         {zero.gradient[21], sum, 2 * support::unit_roundoff<float>});
}
