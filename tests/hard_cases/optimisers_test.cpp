// Optimisers and trainings where gradients, rates and steps are as none should be. References run the same
// steps in double. u is the unit roundoff of single precision.

#include "hold.hpp"

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/training/trainer.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <support/tolerance.hpp>
#include <training/toy_task.hpp>
#include <vector>

using namespace tactnet;
using hard_cases::hold;
using hard_cases::unit;

namespace {

constexpr double u = support::unit_roundoff<float>;

/// One number (in all lanes) under an optimiser.
template <class Rule>
class one_number {
public:
    one_number(const Rule& rule, float value, bool decays) : rule_(rule) {
        state_.resize(size);
        values_.assign(size, value), gradients_.resize(size), decayed_.assign(size, decays ? 1.0f : 0.0f);
    }
    void step(double rate, float gradient) {
        std::fill(gradients_.begin(), gradients_.end(), gradient);
        optimiser_step<float>(rule_, state_, rate, values_, gradients_, decayed_);
    }
    [[nodiscard]] double value() const { return static_cast<double>(values_[0]); }
    [[nodiscard]] const optimiser_state<float>& state() const { return state_; }

private:
    static constexpr std::size_t size = kernels::lanes<float>;
    Rule rule_;
    optimiser_state<float> state_;
    aligned_vector<float> values_, gradients_, decayed_;
};

} // namespace

// The step is rate × 1, whatever the gradient: of its dozen roundings none is larger than 2 u of it.
TEST_CASE("adamw: gradients whose square is hardly a number") {
    for (const float gradient : {1.7e20f, 1e-5f}) {
        one_number number(adamw{.decay = 0}, 0, false);
        number.step(0.5, gradient);
        const double g = static_cast<double>(gradient);
        hold(gradient > 1 ? "AdamW, first gradient 1.7e20" : "AdamW, first gradient 1e-5", unit::relative,
             {-0.5 * g / (g + 1e-8), number.value(), support::accumulated(u, 24)});
    }
}

namespace {

/// Features of a size, two of each class, which a single layer learns from.
struct features {
    std::vector<float> values;
    std::vector<std::size_t> labels{0, 1, 2, 0, 1, 2};
    explicit features(float size) {
        for (std::size_t i = 0; i < labels.size() * 4; ++i)
            values.push_back(size * static_cast<float>(static_cast<int>(i * 7 % 11) - 5));
    }
    [[nodiscard]] labelled_features view() const { return {values, labels, 3}; }
};
using one_layer = network<shape{1, 1, 4}, dense<3>>;

/// Whether a training says that it diverges, and `latest` and `best` are the last ones that did not.
bool diverges_and_keeps(const recipe& how, float size, std::size_t epochs) {
    const features data(size);
    thread_pool threads(1);
    data_split split;
    split.training = {0, 1, 2, 3, 4, 5};
    trainer<one_layer> t(how, data.view(), split, 1, threads);
    std::vector<float> before;
    try {
        for (std::size_t epoch = 0; epoch < epochs; ++epoch) {
            const auto values = t.latest().learnable_values();
            before.assign(values.begin(), values.end());
            t.run_epoch();
        }
    } catch (const training_diverged&) {
        return std::ranges::equal(before, t.latest().learnable_values()) &&
               std::ranges::equal(before, t.best().learnable_values());
    }
    return false;
}

} // namespace

TEST_CASE("trainer: a training that cannot succeed is reported, and the last good weights are kept") {
    recipe how = recipe::on_features();
    how.epochs = 20;
    how.schedule = constant_rate{};
    CHECK(diverges_and_keeps(how, 1e25f, 1)); // gradients of 1e25
    how.optimiser = sgd{};
    how.rate = 1e38;
    CHECK(diverges_and_keeps(how, 1, 20));
    how.optimiser = adamw{};
    CHECK(diverges_and_keeps(how, 1, 20));
}

// Steps shrink by 0.9 ÷ √0.99 each time. About 170 of them move the number, each rounded once; what is lost
// after them is a geometric sum of 11 half units. A step has a dozen roundings of its own, and the
// correction of biases is a double.
TEST_CASE("adamw: one gradient, then zeros for a million steps") {
    const double rate = 0.01;
    one_number number(adamw{.decay = 0}, 1, false);
    double first = 0, second = 0, exact = 1;
    for (int step = 0; step < 1'000'000; ++step) {
        const float g = step == 0 ? 1.0f : 0.0f;
        number.step(rate, g);
        first = 0.9 * first + 0.1 * static_cast<double>(g);
        second = 0.99 * second + 0.01 * static_cast<double>(g);
        const double n = step + 1;
        exact -=
            rate * (first / (1 - std::pow(0.9, n))) / (std::sqrt(second / (1 - std::pow(0.99, n))) + 1e-8);
    }
    hold("AdamW, one gradient, then zeros for a million steps", unit::relative,
         {exact, number.value(), support::accumulated(u, 170 + 11) + 0.12 * 14 * 170 * u});
}

// A velocity that moves by less than half a unit moves no more: half a unit ÷ (1 − momentum), and 1 −
// momentum itself is off by u ÷ (1 − momentum), for the momentum is rounded.
TEST_CASE("sgd: a momentum of 0.999 over a million steps") {
    one_number number(sgd{.momentum = 0.999}, 0, false);
    for (int step = 0; step < 1'000'000; ++step)
        number.step(0, 0.1f);
    hold("SGD, velocity under a momentum of 0.999, a million steps", unit::relative,
         {static_cast<double>(0.1f) / (1 - 0.999), static_cast<double>(number.state().first[0]),
          2 * u / (1 - 0.999) + 2 * u});
}

// Each step rounds once: γ(1e6) of the weight at worst.
TEST_CASE("adamw: weight decay over a million steps") {
    one_number number(adamw{.decay = 0.05}, 1, true);
    for (int step = 0; step < 1'000'000; ++step)
        number.step(2e-5, 0);
    hold("AdamW, weight decay of 1e-6 a step, a million steps", unit::relative,
         {std::pow(1 - 1e-6, 1e6), number.value(), support::accumulated(u, 1e6)});
}

// Nothing stops it: the loss falls towards zero. Its value is a double, of exact logits: 4 roundings and the
// sum of three exponentials, each right to a unit in the last place.
TEST_CASE("trainer: ten thousand epochs on 8 images") {
    const support::toy_task task(8);
    thread_pool threads(1);
    recipe how;
    how.epochs = 10'000;
    how.batch = 0;
    how.schedule = constant_rate{};
    how.augmentation = augmentation_rule::none;
    how.label_smoothing = 0;
    data_split split;
    split.training = {0, 1, 2, 8, 9, 16, 17, 18};
    using net = network<support::toy_task::size, conv2d<4, 3>, batch_norm, relu, max_pool<4>, dense<3>>;
    trainer<net> t(how, task.images(), split, 1, threads);
    while (!t.finished())
        t.run_epoch();
    const evaluation found =
        evaluate(t.latest(), t.input_normalisation(), task.images(), split.training, threads);
    CHECK(found.confusion.correct() == 8);
    CHECK(t.history().back().loss >= 0);
    CHECK(t.history().back().loss < 1e-2);
}
