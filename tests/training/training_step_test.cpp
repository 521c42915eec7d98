#include <tactnet/runtime/random.hpp>
#include <tactnet/training/data/split.hpp>
#include <tactnet/training/loss.hpp>
#include <tactnet/training/optimiser.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <span>
#include <support/tolerance.hpp>
#include <vector>

namespace {

using namespace tactnet;

constexpr shape outputs{1, 1, 7};
template <class T>
using logits = batch<T, outputs, 4>;

/// −Σ wanted × log(probability), by the definition, in extended precision.
long double reference(const logits<double>& x, const std::vector<std::size_t>& labels, std::size_t classes,
                      double smoothing) {
    long double total = 0;
    for (std::size_t s = 0; s < x.samples(); ++s) {
        long double sum = 0;
        for (std::size_t c = 0; c < classes; ++c)
            sum += std::exp(static_cast<long double>(x(s, c)));
        for (std::size_t c = 0; c < classes; ++c) {
            const long double wanted = labels[s] == no_class ? 1 / static_cast<long double>(classes)
                                                             : smoothing / static_cast<double>(classes) +
                                                                   (c == labels[s] ? 1 - smoothing : 0.0);
            total -= wanted * std::log(std::exp(static_cast<long double>(x(s, c))) / sum);
        }
    }
    return total / static_cast<long double>(x.samples());
}

TEST_CASE("softmax_cross_entropy: value and gradient, smoothed and with fewer classes than outputs") {
    for (const std::size_t classes : {7u, 5u, 1u})
        for (const double smoothing : {0.0, 0.1}) {
            CAPTURE(classes);
            CAPTURE(smoothing);
            random_stream random(1, random_purposes::order);
            logits<double> x(6), gradient(6);
            std::vector<std::size_t> labels(6);
            for (std::size_t s = 0; s < 6; ++s) {
                for (std::size_t c = 0; c < 7; ++c)
                    x(s, c) = random.uniform(-3, 3);
                labels[s] = s == 4 ? no_class : s % classes;
            }
            for (std::size_t i = 0; i < gradient.view().lane_blocks() * gradient.view().lane_block_size; ++i)
                gradient.view().data()[i] = 99;
            const double loss = softmax_cross_entropy(x.as_const(), std::span<const std::size_t>(labels),
                                                      classes, smoothing, gradient.view());
            const double bound = support::accumulated(support::unit_roundoff<double>, 30) * 10;
            CHECK(support::within(loss,
                                  {static_cast<double>(reference(x, labels, classes, smoothing)), bound}));
            for (std::size_t s = 0; s < 6; ++s)
                for (std::size_t c = 0; c < 7; ++c) {
                    // Extended precision: the error of the difference is that of its step, h² / 6 of a
                    // third derivative below one, and of roundings of 10 over h.
                    constexpr double h = 1e-6;
                    logits<double> up = x, down = x;
                    up(s, c) += h, down(s, c) -= h;
                    const auto difference =
                        static_cast<double>((reference(up, labels, classes, smoothing) -
                                             reference(down, labels, classes, smoothing)) /
                                            static_cast<long double>(up(s, c) - down(s, c)));
                    CHECK(
                        support::within(gradient(s, c), {difference, h * h + 10 * 30 * 5.5e-20 / h + bound}));
                    if (c >= classes)
                        CHECK(gradient(s, c) == 0);
                }
            for (std::size_t c = 0; c < 7; ++c) // lanes without a sample
                for (std::size_t lane = 2; lane < 4; ++lane)
                    CHECK(gradient.view().lane_block(1)[c * 4 + lane] == 0);
        }
}

TEST_CASE(
    "softmax_cross_entropy: a class that is ruled out costs nothing when it is not wanted; NaN is seen") {
    logits<float> x(1), gradient(1);
    for (std::size_t c = 0; c < 7; ++c)
        x(0, c) = c == 3 ? -std::numeric_limits<float>::infinity() : 0;
    const std::vector<std::size_t> labels{1};
    CHECK(softmax_cross_entropy(x.as_const(), std::span<const std::size_t>(labels), 7, 0.0,
                                gradient.view()) == doctest::Approx(std::log(6.0)));
    CHECK(gradient(0, 3) == 0);
    x(0, 5) = std::nanf("");
    CHECK(std::isnan(
        softmax_cross_entropy(x.as_const(), std::span<const std::size_t>(labels), 7, 0.0, gradient.view())));
}

constexpr std::size_t steps = 20;
const std::size_t size = 3 * kernels::lanes<float>;

float gradient_at(std::size_t step, std::size_t i) {
    random_stream random(1, random_purposes::order, static_cast<std::uint32_t>(step),
                         static_cast<std::uint32_t>(i));
    return static_cast<float>(random.uniform(-1, 1));
}
/// Parameters after some steps, each an instance of reference(value, step, index) in double.
template <class Reference>
void check_steps(const optimiser& rule, double rate, double bound, Reference&& reference) {
    optimiser_state<float> state;
    state.resize(size);
    aligned_vector<float> values(size), gradients(size), decayed(size);
    for (std::size_t i = 0; i < size; ++i) {
        values[i] = static_cast<float>(i % 5) - 2;
        decayed[i] = i % 2 == 0 ? 1.0f : 0.0f; // every other a weight
    }
    const aligned_vector<float> begin = values;
    for (std::size_t step = 0; step < steps; ++step) {
        for (std::size_t i = 0; i < size; ++i)
            gradients[i] = gradient_at(step, i);
        optimiser_step<float>(rule, state, rate, values, gradients, decayed);
    }
    CHECK(state.steps == steps);
    for (std::size_t i = 0; i < size; ++i)
        CHECK(support::within(static_cast<double>(values[i]),
                              {reference(begin[i], i, decayed[i] == 1), bound}));
}

TEST_CASE("optimiser: numbers take their share of the rate") {
    for (const optimiser& rule : {optimiser(sgd{.momentum = 0.8, .l2 = 0.1}), optimiser(adamw{})}) {
        aligned_vector<float> shares(size), decayed(size, 1.0F), gradients(size);
        for (std::size_t i = 0; i < size; ++i)
            shares[i] = i % 3 == 0 ? 0.0F : i % 3 == 1 ? 0.5F : 1.0F;
        // By one rate and shares of it, or each with a rate of its own.
        const auto after = [&](double rate, std::span<const float> of_rate) {
            optimiser_state<float> state;
            state.resize(size);
            aligned_vector<float> values(size, 1.5F);
            for (std::size_t step = 0; step < steps; ++step) {
                for (std::size_t i = 0; i < size; ++i)
                    gradients[i] = gradient_at(step, i);
                optimiser_step<float>(rule, state, rate, values, gradients, decayed, of_rate);
            }
            return values;
        };
        const auto shared = after(0.125, shares), half = after(0.0625, {}), whole = after(0.125, {});
        for (std::size_t i = 0; i < size; ++i)
            CHECK(shared[i] == (i % 3 == 0 ? 1.5F : i % 3 == 1 ? half[i] : whole[i]));
    }
}

TEST_CASE("sgd: momentum, and L2 on weights only") {
    const sgd rule{.momentum = 0.8, .l2 = 0.1};
    const double rate = 0.05;
    // Velocities below 1 / (1 − 0.8) × 1.3; a step rounds value, product and velocity a few times.
    const double bound = support::accumulated(support::unit_roundoff<float>, 8 * steps) * 6.5;
    check_steps(rule, rate, bound, [&](double value, std::size_t i, bool weight) {
        double velocity = 0;
        for (std::size_t step = 0; step < steps; ++step) {
            const double gradient = gradient_at(step, i) + (weight ? 0.1 * value : 0);
            velocity = 0.8 * velocity + gradient;
            value -= rate * velocity;
        }
        return value;
    });
}

TEST_CASE("adamw: both moments unbiased, decay decoupled and on weights only") {
    const adamw rule{.beta1 = 0.9, .beta2 = 0.99, .decay = 0.05, .epsilon = 1e-8};
    const double rate = 0.01;
    // A step is at most about rate × 10 (few steps, small betas); its terms are rounded a dozen times each.
    const double bound =
        support::accumulated(support::unit_roundoff<float>, 16 * steps) * (2 + 10 * rate * steps);
    check_steps(rule, rate, bound, [&](double value, std::size_t i, bool weight) {
        double first = 0, second = 0;
        for (std::size_t step = 0; step < steps; ++step) {
            const double gradient = gradient_at(step, i), n = static_cast<double>(step + 1);
            first = 0.9 * first + 0.1 * gradient;
            second = 0.99 * second + 0.01 * gradient * gradient;
            const double decay = weight ? rate * 0.05 * value : 0;
            value -= decay + rate * (first / (1 - std::pow(0.9, n))) /
                                 (std::sqrt(second / (1 - std::pow(0.99, n))) + 1e-8);
        }
        return value;
    });
}

TEST_CASE("optimiser_step: a gradient of zero moves nothing that is not decayed") {
    for (const optimiser& rule : {optimiser(sgd{.momentum = 0.9, .l2 = 0.1}), optimiser(adamw{})}) {
        optimiser_state<float> state;
        state.resize(kernels::lanes<float>);
        aligned_vector<float> values(kernels::lanes<float>, 2.0f), gradients(kernels::lanes<float>),
            decayed(kernels::lanes<float>);
        optimiser_step<float>(rule, state, 0.1, values, gradients, decayed);
        CHECK(values[0] == 2);
        decayed.assign(decayed.size(), 1);
        optimiser_step<float>(rule, state, 0.1, values, gradients, decayed);
        CHECK(values[0] < 2);
    }
}

// Without gradients the moments fade, and denormal numbers cost time.
TEST_CASE(
    "optimiser_step: what an optimiser remembers fades to zero, or to a divisor that is no denormal number") {
    for (const optimiser& rule : {optimiser(sgd{.momentum = 0.9}), optimiser(adamw{.decay = 0})}) {
        optimiser_state<float> state;
        state.resize(kernels::lanes<float>);
        aligned_vector<float> values(kernels::lanes<float>, 2.0f), gradients(kernels::lanes<float>, 1.0f),
            none(kernels::lanes<float>);
        optimiser_step<float>(rule, state, 0.1, values, gradients, none);
        for (int step = 0; step < 12'000; ++step)
            optimiser_step<float>(rule, state, 0.1, values, none, none);
        CHECK(state.first[0] == 0);
        CHECK(state.second[0] == (rule.index() == 0 ? 0 : 0x1p-116f));
    }
    // What was never moved stays zero, and a NaN stays one.
    optimiser_state<float> state;
    state.resize(kernels::lanes<float>);
    aligned_vector<float> values(kernels::lanes<float>), none(kernels::lanes<float>);
    optimiser_step<float>(adamw{}, state, 0.1, values, none, none);
    CHECK(state.second[0] == 0);
    none[0] = std::nanf("");
    optimiser_step<float>(adamw{}, state, 0.1, values, none, values);
    CHECK(std::isnan(state.first[0]));
    CHECK(std::isnan(state.second[0]));
}

TEST_CASE("decay_mask: weights decay, norms only by the rule, biases and statistics never") {
    const std::vector<parameter> parameters{{{"weight", {2}, {}, 0, 2}, parameter_role::weight, 1},
                                            {{"bias", {1}, {}, 2, 1}, parameter_role::bias, 1},
                                            {{"scale", {1}, {}, 3, 1}, parameter_role::scale, 1},
                                            {{"shift", {1}, {}, 4, 1}, parameter_role::shift, 1},
                                            {{"mean", {1}, {}, 0, 1}, parameter_role::running_mean, 1}};
    const auto mask = [&](const optimiser& rule) { return detail::decay_mask(rule, parameters, 6); };
    const aligned_vector<float> weights{1, 1, 0, 0, 0, 0}, norms_too{1, 1, 0, 1, 1, 0};
    CHECK(mask(sgd{.l2 = 0.1}) == weights);
    CHECK(mask(adamw{}) == weights);
    CHECK(mask(sgd{.l2 = 0.1, .l2_of_norms = true}) == norms_too);
}

} // namespace
