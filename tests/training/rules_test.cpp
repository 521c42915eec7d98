#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/training/early_stopping.hpp>
#include <tactnet/training/initialise.hpp>
#include <tactnet/training/metrics.hpp>
#include <tactnet/training/recipe.hpp>
#include <tactnet/training/schedule.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

using namespace tactnet;

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
    double before = 0;
    for (double epoch = 0; epoch <= 80; epoch += 0.5) { // up, then down
        const double rate = rate_at(cycle, 0.01, epoch, 80);
        CHECK((epoch <= 20 ? rate >= before : rate <= before));
        before = rate;
    }
}

TEST_CASE("early_stopping: after `patience` checks without a smaller loss") {
    early_stopping stopping(3);
    CHECK(!stopping.check(2));
    CHECK(!stopping.check(1));
    CHECK(!stopping.check(1)); // no better
    CHECK(!stopping.check(5));
    CHECK(!stopping.check(0.5));
    CHECK(stopping.waited() == 0);
    CHECK(!stopping.check(std::numeric_limits<double>::quiet_NaN()));
    CHECK(!stopping.check(0.6));
    CHECK(stopping.check(0.7));
    CHECK(stopping.smallest() == 0.5);

    early_stopping again(3);
    again.restore(0.5, 2);
    CHECK(again.check(0.5));
    early_stopping never;
    for (int i = 0; i < 100; ++i)
        CHECK(!never.check(1));
}

TEST_CASE("initialise: deviations, zeros and ones; a function of the seed") {
    using net_type = tactnet4<shape{28, 50, 1}, 22>;
    net_type net, same, other;
    for (const bool he : {false, true}) {
        const initialisation rule = he ? initialisation(he_normal{}) : initialisation(fixed_normal{0.01});
        for (float& v : net.learnable_values())
            v = 99;
        for (float& v : net.running_statistics())
            v = 99;
        initialise(net, rule, 1);
        net.for_each_parameter([&](const parameter& p, std::span<float> values) {
            CAPTURE(p.name);
            if (p.what != role::weight) {
                const bool one = p.what == role::scale || p.what == role::running_variance;
                CHECK(std::all_of(values.begin(), values.end(), [&](float v) { return v == (one ? 1 : 0); }));
                return;
            }
            const double expected = he ? std::sqrt(2.0 / static_cast<double>(p.fan_in)) : 0.01;
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
    initialise(same, he_normal{}, 1);
    initialise(other, he_normal{}, 2);
    CHECK(values(net) == values(same));
    CHECK(values(net) != values(other));
    CHECK(net.learnable_values()[0] != net.learnable_values()[208 + 16]); // arrays are not drawn alike
}

TEST_CASE("confusion_matrix") {
    confusion_matrix m(3), n(3);
    CHECK(std::isnan(m.accuracy()));
    m.add(0, 0);
    m.add(1, 2);
    n.add(1, 2);
    n.add(2, 2);
    m.add(n);
    CHECK(m(1, 2) == 2);
    CHECK(m(2, 1) == 0);
    CHECK(m.total() == 4);
    CHECK(m.correct() == 2);
    CHECK(m.accuracy() == 0.5);
    CHECK(m.classes() == 3);
}

TEST_CASE("mean_and_deviation") {
    const auto m = mean_and_deviation::of(std::array{2.0, 4.0, 4.0, 6.0});
    CHECK(m.mean == doctest::Approx(4));
    CHECK(m.deviation == doctest::Approx(std::sqrt(8.0 / 3)));
    CHECK(mean_and_deviation::of(std::array{3.0}).deviation == 0);
    CHECK(mean_and_deviation::of({}).mean == 0);
    // Twenty evaluations without a mistake are no better than that.
    CHECK(mean_and_deviation::of(std::vector<double>(20, 1.0)).mean == 1);
    CHECK(mean_and_deviation::of(std::vector<double>(20, 1.0)).deviation == 0);
}

TEST_CASE("recipe::published: as in the paper") {
    const recipe r = recipe::published(28, 50, 0.01, 150, 4);
    CHECK(std::get<sgd>(r.optimiser).momentum == 0.8);
    CHECK(std::get<sgd>(r.optimiser).l2 == 1e-4);
    CHECK(std::get<step_drop>(r.schedule).period == 150);
    CHECK(std::get<step_drop>(r.schedule).factor == 0.1);
    CHECK(std::get<fixed_normal>(r.initialisation).deviation == 0.01);
    CHECK(r.batch == 0);
    CHECK(r.rate == 0.01);
    CHECK(r.validate_every == 10);
    CHECK(r.patience == 4);
    CHECK(r.label_smoothing == 0);
    CHECK(std::holds_alternative<constant_rate>(recipe::published(28, 50, 0.002, 0, 5).schedule));
}
