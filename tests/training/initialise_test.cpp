#include <tactnet/layers/activations/parametric_relu.hpp>
#include <tactnet/layers/dense.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/training/initialise.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

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
