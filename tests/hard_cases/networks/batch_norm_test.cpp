#include <tactnet/operators/training.hpp>

// Batch norms whose variance is nothing or denormal, whose mean lies far away, that run for long; and the
// same folded into a convolution for deployment. u is the unit roundoff of single precision.

#include "../hold.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deployment/deployed_network.hpp>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <support/layers/erased.hpp>
#include <vector>

using namespace tactnet;
using hard_cases::outcome;
using hard_cases::unit;

namespace {

constexpr double u = support::unit_roundoff<float>;

/// One channel, 4 × 5 pixels.
constexpr shape image{4, 5, 1};
using norm = trained_layer<batch_norm, float, image>;
using images = batch<float, image, kernels::lanes<float>>;

images images_of(const std::vector<float>& values) {
    images in(values.size() / image.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        in(i / image.size(), i % image.size()) = values[i];
    return in;
}
/// A pattern within ±1 that adds up to no round number.
std::vector<float> pattern(std::size_t samples, float middle, float size) {
    std::vector<float> values(samples * image.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = middle + size * static_cast<float>(static_cast<int>(i * 37 % 101) - 50) / 64;
    return values;
}

std::vector<float> trained_outputs(const std::vector<float>& values, double epsilon) {
    thread_pool threads(1);
    const images in = images_of(values);
    images out(in.samples());
    norm::memory memory;
    memory.resize(in.samples());
    const std::vector<float> scale_and_shift{1, 0};
    std::vector<float> running{0, 1};
    support::run_forward<norm>({.threads = threads, .epsilon = epsilon}, scale_and_shift.data(),
                               running.data(), memory, in.view(), out.view());
    std::vector<float> found(values.size());
    for (std::size_t i = 0; i < found.size(); ++i)
        found[i] = out(i / image.size(), i % image.size());
    return found;
}
std::vector<double> normalised(const std::vector<float>& values, double epsilon) {
    long double sum = 0, squares = 0;
    for (const float v : values)
        sum += v;
    const long double mean = sum / static_cast<long double>(values.size());
    for (const float v : values)
        squares += (v - mean) * (v - mean);
    const long double deviation =
        std::sqrt(squares / static_cast<long double>(values.size()) + static_cast<long double>(epsilon));
    std::vector<double> out;
    for (const float v : values)
        out.push_back(static_cast<double>((v - mean) / deviation));
    return out;
}

/// Moments are measured from the first value: a difference d is rounded once, runs of 16 terms d and d² are
/// added in single precision, runs in double. With D the largest |d| that leaves at most γ(17) D in the mean
/// and γ(19) D² in the variance, which is half as much, relative, in the deviation. The norm itself rounds x
/// − mean, the scale, the rest of the mean and the sum: γ(4) (|y| + what the mean is off ÷ deviation).
void check_trained(const std::string& name, const std::vector<float>& values, double epsilon) {
    const std::vector<double> exact = normalised(values, epsilon);
    const std::vector<float> ours = trained_outputs(values, epsilon);
    double farthest = 0, squares = 0, mean = 0;
    for (const float v : values) {
        farthest = std::max(farthest, std::abs(static_cast<double>(v) - static_cast<double>(values[0])));
        mean += static_cast<double>(v) / static_cast<double>(values.size());
    }
    for (const float v : values)
        squares += std::pow(static_cast<double>(v) - mean, 2) / static_cast<double>(values.size());
    const double variance = squares + epsilon, deviation = std::sqrt(variance);
    const double of_mean = support::accumulated(u, 17) * farthest / deviation,
                 of_deviation = support::accumulated(u, 19) * farthest * farthest / variance / 2;
    // In double a mean of 1e6 is off by 2^-53 of itself, twice.
    const double of_double = 0x1p-52 * std::abs(mean) / deviation;
    std::vector<outcome> all;
    for (std::size_t i = 0; i < values.size(); ++i)
        all.push_back({exact[i], static_cast<double>(ours[i]),
                       of_mean + of_double + std::abs(exact[i]) * of_deviation +
                           support::accumulated(u, 4) * (std::abs(exact[i]) + of_mean) + 0x1p-149});
    hard_cases::hold(name, unit::absolute, all);
}

} // namespace

TEST_CASE("batch_norm: no variance, little variance and means far away, in training") {
    check_trained("variance 0, ε 1e-5", std::vector<float>(60, 123.456f), 1e-5);
    check_trained("variance 0, ε 1e-12", std::vector<float>(60, 123.456f), 1e-12);
    check_trained("variance 3e-13, ε 1e-12", pattern(3, 0, 1e-6f), 1e-12);
    check_trained("values of 1e-40 (denormal), ε 1e-12", pattern(3, 0, 1e-40f), 1e-12);
    check_trained("mean 1e6 deviations away", pattern(3, 1e6f, 2), 1e-5);
    check_trained("mean 2e4, deviation 0.004", pattern(3, 2e4f, 0.0078125f), 1e-12);
    check_trained("values of 1e18", pattern(3, 0, 1e18f), 1e-5);
    check_trained("a batch of one sample, one channel", pattern(1, 50, 1), 1e-5);
}

// A step that moves less than half a unit in the last place moves nothing: with a share of a tenth, running
// moments come to rest up to 5 units from a mean that no longer changes. One unit more for rounding.
TEST_CASE("batch_norm: running moments after a million steps") {
    thread_pool threads(1);
    const std::vector<float> values = pattern(2, 1000.3f, 1);
    const images in = images_of(values);
    norm::memory memory;
    memory.resize(in.samples());
    const execution_context p{.threads = threads, .epsilon = 1e-5};
    std::vector<float> running{0, 1};
    norm::observe_forward(p, memory, in.view());
    for (int step = 0; step < 1'000'000; ++step)
        norm::begin_forward(p, running.data(), memory, in.samples());
    double mean = 0, squares = 0;
    for (const float v : values)
        mean += static_cast<double>(v) / static_cast<double>(values.size());
    for (const float v : values)
        squares += std::pow(static_cast<double>(v) - mean, 2) / static_cast<double>(values.size() - 1);
    hard_cases::hold("running mean after a million steps", unit::ulp,
                     {mean, static_cast<double>(running[0]), 6});
    // The variance of one batch is off by γ(19) D² / 2 besides, D twice 0.8 and the variance a quarter: 19
    // units.
    hard_cases::hold("running variance after a million steps", unit::ulp,
                     {squares, static_cast<double>(running[1]), 6 + 19 * 2.6 / 0.2 / 2});
}

namespace {

using folding = network<shape{4, 5, 2}, conv2d<4, 3>, batch_norm, dense<3>>;

/// The network with each channel's running moments, deployed, compared with the bound of the numbers that it
/// has then.
void check_folded(const std::string& name, float mean, float variance, double epsilon, float bias) {
    folding net;
    support::fill(net, 3);
    net.epsilon = epsilon;
    net.for_each_parameter([&](const parameter& p, auto values) {
        if (p.role == parameter_role::running_mean)
            std::fill(values.begin(), values.end(), mean);
        if (p.role == parameter_role::running_variance)
            std::fill(values.begin(), values.end(), variance);
        if (p.role == parameter_role::bias && values.size() == 4)
            std::fill(values.begin(), values.end(), bias);
    });
    const auto layers = support::describe<folding>();
    const auto parameters = support::parameters_of(net);
    const auto fast = deploy(net);
    std::vector<float> frame(folding::input_shape.size()), out(folding::outputs);
    support::numbers draw(5);
    for (float& value : frame)
        value = draw.next(-1, 1);
    CHECK(fast.infer(tensor_view<const float, folding::input_shape>(frame.data()),
                     std::span<float, folding::outputs>(out)) == frame_status::ok);
    const auto expected = support::bounded_outputs(layers, parameters, support::bounded_input(frame, {}, 1));
    std::vector<outcome> all;
    for (std::size_t o = 0; o < out.size(); ++o)
        all.push_back({expected[o].value, static_cast<double>(out[o]), expected[o].error});
    hard_cases::hold(name + ", deployed", unit::absolute, all);
}

bool refused(float variance, double epsilon) {
    folding net;
    support::fill(net, 3);
    net.epsilon = epsilon;
    net.for_each_parameter([&](const parameter& p, auto values) {
        if (p.role == parameter_role::running_variance)
            values[1] = variance;
    });
    try {
        static_cast<void>(deploy(net));
    } catch (const std::invalid_argument&) {
        return true;
    }
    return false;
}

} // namespace

TEST_CASE("batch_norm: the same folded for deployment") {
    check_folded("variance 0, ε 1e-5", 0.25f, 0, 1e-5, 0.25f);
    check_folded("variance 0, ε 1e-12", 0.25f, 0, 1e-12, 0.25f);
    check_folded("variance 1e-12, ε 1e-12", 0.25f, 1e-12f, 1e-12, 0.25f);
    check_folded("denormal variance, ε 1e-12", 0.25f, 1e-40f, 1e-12, 0.25f);
    check_folded("mean 1e6 deviations away", 1e6f, 1, 1e-5, 1e6f);
    CHECK(refused(0, 0));
    CHECK(refused(-1, 1e-5));
    CHECK(refused(NAN, 1e-5));
}
