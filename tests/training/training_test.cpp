#include <tactnet/networks/network.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>
#include <tactnet/operators/activations/layer.hpp>
#include <tactnet/operators/dense/layer.hpp>
#include <tactnet/training/initialise.hpp>
#include <tactnet/training/metrics.hpp>
#include <tactnet/training/recipe.hpp>
#include <tactnet/training/schedule.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <tuple>
#include <variant>
#include <vector>

namespace {

using namespace tactnet;

TEST_CASE("initialise: deviations, zeros and ones; a function of the seed") {
    using net_type = tactnet4<shape{28, 50, 1}, 22>;
    net_type net, again, other;
    for (const bool by_he : {false, true}) {
        const initialisation rule = by_he ? initialisation(he_normal{}) : initialisation(fixed_normal{0.01});
        for (float& v : net.learnable_values())
            v = 99;
        for (float& v : net.running_statistics())
            v = 99;
        initialise(net, rule, 1);
        net.for_each_parameter([&](const parameter& p, std::span<float> values) {
            CAPTURE(p.name);
            if (p.role != parameter_role::weight) {
                const bool one =
                    p.role == parameter_role::scale || p.role == parameter_role::running_variance;
                CHECK(std::all_of(values.begin(), values.end(), [&](float v) { return v == (one ? 1 : 0); }));
                return;
            }
            const double expected = by_he ? std::sqrt(2.0 / static_cast<double>(p.fan_in)) : 0.01;
            const auto n = static_cast<double>(values.size());
            double sum = 0, squares = 0;
            for (const float v : values)
                sum += static_cast<double>(v), squares += static_cast<double>(v) * static_cast<double>(v);
            CHECK(std::abs(sum / n) < 5 * expected / std::sqrt(n));
            CHECK(std::abs(squares / n / (expected * expected) - 1) < 5 * std::sqrt(2 / n));
        });
    }
    const auto values = [](const net_type& of) {
        const auto learned = of.learnable_values().first(net_type::parameters);
        return std::vector<float>(learned.begin(), learned.end());
    };
    initialise(net, he_normal{}, 1);
    initialise(again, he_normal{}, 1);
    initialise(other, he_normal{}, 2);
    CHECK(values(net) == values(again));
    CHECK(values(net) != values(other));
    CHECK(net.learnable_values()[0] != net.learnable_values()[208 + 16]); // arrays are not drawn alike
}

TEST_CASE("initialise: slopes of a parametric ReLU are a quarter, as in PyTorch") {
    network<shape{3, 4, 5}, parametric_relu, dense<2>> net;
    const auto slopes_are_a_quarter = [&] {
        const auto slopes = net.learnable_values().first(5);
        return std::all_of(slopes.begin(), slopes.end(), [](float v) { return v == 0.25f; });
    };
    CHECK(slopes_are_a_quarter());
    std::fill(net.learnable_values().begin(), net.learnable_values().end(), 99.0f);
    initialise(net, he_normal{}, 1);
    CHECK(slopes_are_a_quarter());
}

TEST_CASE("confusion_matrix: counts and the rates computed from them") {
    confusion_matrix m(3), n(3);
    CHECK(std::isnan(m.accuracy()));
    m.add(0, 0);
    m.add(1, 2);
    n.add(1, 2);
    n.add(2, 2);
    m.add(n);
    CHECK(m.count(0, 0) == 1);
    n.add(0, 0);
    m.add(n);
    CHECK(m.count(0, 0) == 2); // the first of all counts, too
    CHECK(m.count(1, 2) == 3);
    m = confusion_matrix(3);
    m.add(0, 0), m.add(1, 2), m.add(1, 2), m.add(2, 2);
    CHECK(m.count(1, 2) == 2);
    CHECK(m.count(2, 1) == 0);
    CHECK(m.total() == 4);
    CHECK(m.correct() == 2);
    CHECK(m.accuracy() == 0.5);
    CHECK(m.classes() == 3);
}

TEST_CASE("mean_and_deviation: of samples, of one and of none") {
    const auto m = mean_and_deviation::of(std::array{2.0, 4.0, 4.0, 6.0});
    CHECK(m.mean == doctest::Approx(4));
    CHECK(m.deviation == doctest::Approx(std::sqrt(8.0 / 3)));
    CHECK(mean_and_deviation::of(std::array{-1.0, 4.0}).deviation == doctest::Approx(std::sqrt(12.5)));
    CHECK(mean_and_deviation::of(std::array{3.0}).deviation == 0);
    CHECK(mean_and_deviation::of({}).mean == 0);
    // Twenty evaluations without a mistake are no better than that.
    CHECK(mean_and_deviation::of(std::vector<double>(20, 1.0)).mean == 1);
    CHECK(mean_and_deviation::of(std::vector<double>(20, 1.0)).deviation == 0);
    // Distances from the mean are squared, which are exact here, unlike differences of squares.
    CHECK(mean_and_deviation::of(std::array{1e17, 1e17 + 64, 1e17 + 128, 1e17 + 320}).deviation ==
          doctest::Approx(64 * std::sqrt(14.0 / 3)));
}

TEST_CASE("rate_at: constant and step drop") {
    CHECK(rate_at(schedule(constant_rate{}), 0.05, 99.5, 100) == 0.05);
    const schedule drop = step_drop{.period = 200, .factor = 0.1};
    CHECK(rate_at(drop, 0.05, 0, 1000) == 0.05);
    CHECK(rate_at(drop, 0.05, 199.9, 1000) == 0.05);
    CHECK(rate_at(drop, 0.05, 200, 1000) == doctest::Approx(0.005));
    CHECK(rate_at(drop, 0.05, 400, 1000) == doctest::Approx(0.0005));
}

TEST_CASE("rate_at: one cycle") {
    const schedule cycle = one_cycle{.warm_up = 0.25};
    CHECK(rate_at(cycle, 0.01, 0, 80) == doctest::Approx(0.01 / 25));
    CHECK(rate_at(cycle, 0.01, 10, 80) == doctest::Approx(0.01 * (1 + 1.0 / 25) / 2));
    CHECK(rate_at(cycle, 0.01, 20, 80) == doctest::Approx(0.01));
    CHECK(rate_at(cycle, 0.01, 50, 80) == doctest::Approx(0.005).epsilon(1e-4));
    CHECK(rate_at(cycle, 0.01, 80, 80) == doctest::Approx(1e-8));
    CHECK(rate_at(one_cycle{}, 0.01, 20, 80) == doctest::Approx(0.01)); // a quarter by default
    double before = 0;
    for (double epoch = 0; epoch <= 80; epoch += 0.5) { // up, then down
        const double rate = rate_at(cycle, 0.01, epoch, 80);
        CHECK((epoch <= 20 ? rate >= before : rate <= before));
        before = rate;
    }
}

TEST_CASE("recipe::published: as in the authors' programs for pretrained networks") {
    const published_training own{.rate = 2e-3,
                                 .drop_period = 0,
                                 .patience = 4,
                                 .transfer =
                                     published_transfer{.epochs = 10, .batch = 5, .new_layer_factor = 20}};
    const recipe r = recipe::published(28, 50, own);
    CHECK(std::get<sgd>(r.optimiser).momentum == 0.9);
    CHECK(std::get<sgd>(r.optimiser).l2 == 1e-4);
    CHECK(std::holds_alternative<constant_rate>(r.schedule));
    CHECK(r.rate * r.pretrained_rate == doctest::Approx(1e-4));
    CHECK(r.epochs == 10);
    CHECK(r.batch == 5);
    CHECK(r.patience == 4);
    CHECK(r.input == input_rule::scale);
    CHECK(r.augmentation == augmentation_rule::none);
}

TEST_CASE("recipe::fine_tuning: the published one on reflected images, with one cycle, for a third "
          "longer") {
    const published_training own{.rate = 2e-3,
                                 .drop_period = 0,
                                 .patience = 4,
                                 .transfer =
                                     published_transfer{.epochs = 15, .batch = 64, .new_layer_factor = 20}};
    const recipe r = recipe::fine_tuning(own);
    CHECK(r.name == "default");
    CHECK(r.epochs == 20);
    CHECK(r.batch == 64);
    CHECK(r.rate == 4e-3);
    CHECK(r.pretrained_rate == doctest::Approx(1.0 / 20));
    CHECK(std::get<sgd>(r.optimiser).momentum == 0.9);
    CHECK(std::holds_alternative<one_cycle>(r.schedule));
    CHECK(r.input == input_rule::scale);
    CHECK(r.augmentation == augmentation_rule::each_epoch);
    CHECK(r.ranges == augmentation_ranges{.reflect_rows = 0.5, .reflect_columns = 0.5});
    CHECK(r.averaging == 0.95);
    CHECK(r.patience == 0);
    CHECK_THROWS_WITH_AS(static_cast<void>(recipe::fine_tuning(tactnet6_training({28, 50}))),
                         doctest::Contains("published_training::transfer), found none"),
                         std::invalid_argument);
}

TEST_CASE("recipe::thorough: the same with three times as many epochs, erased parts and "
          "sharpness-aware gradients; the last is kept") {
    recipe expected = recipe::default_for(14, 25);
    const recipe found = expected.thorough();
    CHECK(found.name == "thorough");
    CHECK(found.epochs == 3 * 440);
    CHECK(found.rate == expected.rate);
    expected.ranges.erase = 0.5;
    CHECK(found.ranges == expected.ranges);
    CHECK(found.averaging == expected.averaging);
    CHECK(found.sharpness_radius == 0.1);
    CHECK(found.keeps_last);
}

TEST_CASE("recipe::default_for: small images are learnt from longer, four times as long at most") {
    CHECK(recipe::default_for(28, 50).epochs == 110);
    CHECK(recipe::default_for(20, 35).epochs == 220);
    CHECK(recipe::default_for(14, 25).epochs == 440);
    CHECK(recipe::default_for(7, 13).epochs == 440);
    CHECK(recipe::default_for(1, 1).epochs == 440);
    CHECK(recipe::default_for(224, 224).epochs == 110);
    CHECK(recipe::default_for(0, 0).epochs == 440);
    CHECK(recipe::default_for(28, 50).ranges.translation == 4);
    CHECK(recipe::default_for(14, 25).ranges.translation == 2);
    CHECK(recipe::default_for(28, 50).ranges.pressure == 0.3);
    // The ends of a narrow array move as far, compared with its width.
    for (const auto& [rows, columns, rotation] :
         {std::tuple(28u, 50u, 15.0), {64u, 32u, 15.0}, {16u, 16u, 15.0}, {4u, 40u, 3.0}, {40u, 4u, 3.0}})
        CHECK(recipe::default_for(rows, columns).ranges.rotation == rotation);
}

TEST_CASE("recipe::suited_to: few images are learnt from for more epochs, 16 times as many at most") {
    const recipe usual = recipe::default_for(28, 50);
    for (const auto& [images, epochs] :
         {std::pair{0u, 1760u}, {22u, 1760u}, {44u, 880u}, {351u, 110u}, {704u, 110u}, {100000u, 110u}})
        CHECK(usual.suited_to(images).epochs == epochs);
    CHECK(usual.thorough().suited_to(176).epochs == 660);
    CHECK(usual.suited_to(15).ranges == usual.ranges);
}

TEST_CASE("recipe::on_features: no new samples are made, and the rate falls to nothing over few epochs") {
    const recipe r = recipe::on_features();
    CHECK(r.augmentation == augmentation_rule::none);
    CHECK(r.epochs == 30);
    CHECK(r.label_smoothing == 0.05);
    CHECK(r.epsilon == 1e-5);
    CHECK(r.rate == 3e-3);
    CHECK(r.averaging == 0);
    CHECK(std::holds_alternative<adamw>(r.optimiser));
    CHECK(std::holds_alternative<one_cycle>(r.schedule));
}

TEST_CASE("recipe::published: as in the authors' programs at 28 x 50") {
    const recipe r = recipe::published(28, 50, tactnet6_training({28, 50}));
    CHECK(std::get<sgd>(r.optimiser).momentum == 0.8);
    CHECK(std::get<sgd>(r.optimiser).l2 == 1e-4);
    CHECK(std::get<sgd>(r.optimiser).l2_of_norms);
    CHECK(std::get<step_drop>(r.schedule).period == 150);
    CHECK(std::get<step_drop>(r.schedule).factor == 0.1);
    CHECK(std::get<fixed_normal>(r.initialisation).deviation == 0.01);
    CHECK(r.epochs == 5000);
    CHECK(r.batch == 0);
    CHECK(r.rate == 0.01);
    CHECK(r.input == input_rule::subtract_mean);
    CHECK(r.validate_every == 10);
    CHECK(r.patience == 4);
    CHECK(r.label_smoothing == 0);
    CHECK(r.remeasure_statistics);
}

TEST_CASE("recipe::published: a network may have its own drops, validations and input") {
    const recipe small = recipe::published(14, 25, tactnet6_training({14, 25}));
    CHECK(std::get<step_drop>(small.schedule).factor == 0.7);
    CHECK(small.validate_every == 15);
    CHECK(small.patience == 7);
    CHECK(small.ranges.rotation == 3);
    const recipe residual = recipe::published(28, 50, tactresnet_training({28, 50}));
    CHECK(std::holds_alternative<constant_rate>(residual.schedule));
    CHECK(residual.input == input_rule::counts);
    CHECK(residual.rate == 0.002);
}

} // namespace
