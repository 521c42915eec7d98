#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/training/loop/gradient_step.hpp>
#include <tactnet/training/loop/trainable.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

using namespace tactnet;

namespace {

using net = network<shape{6, 6}, conv2d<2, 3>, batch_norm, relu, dense<3>>;

} // namespace

TEST_CASE(
    "sam_perturbation: by the radius in the gradient's direction, and back with the statistics of before") {
    trainable_network<net> walker;
    const auto values = walker.learnable_values(), statistics = walker.running_statistics();
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = 0.01F * static_cast<float>(i);
    std::ranges::fill(statistics, 3.0F);
    const std::vector<float> before(values.begin(), values.end());
    std::vector<float> gradients(values.size());
    gradients[1] = 3, gradients[4] = -4;

    detail::sam_perturbation path;
    path.climb(walker, gradients, 0.5);
    CHECK(values[0] == before[0]);
    CHECK(values[1] == doctest::Approx(before[1] + 0.3F));
    CHECK(values[4] == doctest::Approx(before[4] - 0.4F));

    std::ranges::fill(statistics, 7.0F);
    path.come_back(walker);
    CHECK(std::ranges::equal(values, before));
    CHECK(std::ranges::all_of(statistics, [](float s) { return s == 3; }));
}

TEST_CASE(
    "sam_perturbation: where there is no slope nothing moves, and tiny or huge ones give the same distance") {
    trainable_network<net> walker;
    const auto values = walker.learnable_values();
    std::ranges::fill(values, 0.0F);
    std::vector<float> gradients(values.size());
    detail::sam_perturbation path;
    path.climb(walker, gradients, 0.5);
    CHECK(std::ranges::all_of(values, [](float v) { return v == 0; }));
    path.come_back(walker);
    for (const float size : {1e-30F, 1e30F}) {
        gradients[2] = size;
        path.climb(walker, gradients, 0.5);
        CHECK(values[2] == doctest::Approx(0.5F));
        path.come_back(walker);
    }
}
