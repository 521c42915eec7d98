#include <tactnet/operators/training.hpp>
#include <tactnet/runtime/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <support/layers/conformance.hpp>
#include <support/layers/erased.hpp>
#include <support/tolerance.hpp>
#include <vector>

using namespace tactnet;

namespace {

using bound = trained_layer<batch_norm, float, shape{3, 2, 2}>;
using images = batch<float, shape{3, 2, 2}, kernels::lanes<float>>;

struct trained {
    images out;
    std::vector<float> running{0, 0, 1, 1}; // means, variances
};

trained train(const images& in, double epsilon = 1e-5) {
    thread_pool threads;
    bound::memory memory;
    memory.resize(in.samples());
    const std::vector<float> values{1, 1, 0, 0};
    trained t{images(in.samples())};
    support::run_forward<bound>({.threads = threads, .epsilon = epsilon}, values.data(), t.running.data(),
                                memory, in.view(), t.out.view());
    return t;
}

} // namespace

TEST_CASE("batch_norm: a channel without deviation becomes its shift") {
    images in(5);
    for (std::size_t s = 0; s < 5; ++s)
        for (std::size_t e = 0; e < 12; ++e)
            in(s, e) = e < 6 ? 123.456f : static_cast<float>(s * e);
    const trained t = train(in);
    for (std::size_t s = 0; s < 5; ++s)
        for (std::size_t e = 0; e < 6; ++e)
            CHECK(t.out(s, e) == 0);
    CHECK(t.running[2] == doctest::Approx(0.9)); // a variance of zero moved it from one
}

TEST_CASE("batch_norm: running statistics move by a tenth, with the unbiased variance") {
    images in(2); // channel 0: 0 … 11, channel 1: a constant
    for (std::size_t s = 0; s < 2; ++s)
        for (std::size_t e = 0; e < 6; ++e)
            in(s, e) = static_cast<float>(6 * s + e), in(s, 6 + e) = 3;
    const trained t = train(in);
    CHECK(t.running[0] == doctest::Approx(0.1 * 5.5));
    CHECK(t.running[1] == doctest::Approx(0.1 * 3));
    CHECK(t.running[2] == doctest::Approx(0.9 + 0.1 * 13)); // Σ (i − 5.5)² = 143, over 11
    CHECK(t.running[3] == doctest::Approx(0.9));
}

TEST_CASE("batch_norm: a single sample has the moments of its pixels") {
    images in(1);
    for (std::size_t e = 0; e < 12; ++e)
        in(0, e) = static_cast<float>(e % 6);
    const trained t = train(in, 0);
    const double deviation = std::sqrt(35.0 / 12);
    for (std::size_t e = 0; e < 12; ++e)
        CHECK(t.out(0, e) == doctest::Approx((static_cast<double>(e % 6) - 2.5) / deviation));
}

TEST_CASE("batch_norm: a NaN is seen in its channel and nowhere else") {
    images in(3);
    in(1, 2) = std::nanf("");
    const trained t = train(in);
    CHECK(std::isnan(t.out(0, 0)));
    CHECK(!std::isnan(t.out(0, 6)));
}

TEST_CASE("batch_norm: two numbers give the unbiased running variance, a single one counts as zero") {
    using single = trained_layer<batch_norm, float, shape{1, 1, 1}>;
    for (const std::size_t samples : {1u, 2u}) {
        thread_pool threads;
        single::memory memory;
        memory.resize(samples);
        const std::vector<float> values{1, 0};
        std::vector<float> running{0, 1};
        batch<float, shape{1, 1, 1}, kernels::lanes<float>> in(samples), out(samples);
        for (std::size_t i = 0; i < samples; ++i)
            in(i, 0) = static_cast<float>(4 * i);
        support::run_forward<single>({.threads = threads}, values.data(), running.data(), memory, in.view(),
                                     out.view());
        CHECK(running[1] == doctest::Approx(samples == 2 ? 0.9 + 0.1 * 8 : 0.9));
    }
}

// Group, instance and layer norms of frames that break a norm computed in single precision from two moments.

namespace {

constexpr shape image{3, 4, 4};
constexpr float scale = 1.5F, shift = -0.25F;

/// The outputs of a norm for one sample, with one scale and one shift for all channels.
template <class Norm>
std::vector<float> outputs_of(const std::vector<float>& frame, double epsilon = 1e-5) {
    const auto layer = support::make_layer<Norm, float, image>();
    aligned_vector<float> values(layer->parameters, scale);
    std::fill(values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end(), shift);
    batch<float, image, kernels::lanes<float>> in(1), out(1);
    for (std::size_t e = 0; e < image.size(); ++e)
        in(0, e) = frame[e];
    thread_pool threads(1);
    layer->resize(1);
    layer->infer({.threads = threads, .epsilon = epsilon}, values.data(), nullptr, 1, in.view().data(),
                 out.view().data());
    std::vector<float> found(image.size());
    for (std::size_t e = 0; e < image.size(); ++e)
        found[e] = out(0, e);
    return found;
}

/// How many outputs of a layer norm of the frame are further from the exact ones than one rounding, and what
/// double precision leaves: 2⁻⁴⁰, thousands of its roundings, of the largest term.
std::size_t outputs_outside(const std::vector<float>& frame, double epsilon = 1e-5) {
    using wide = long double;
    const auto count = static_cast<wide>(frame.size());
    wide mean = 0, variance = 0;
    for (const float x : frame)
        mean += static_cast<wide>(x) / count;
    for (const float x : frame)
        variance += (static_cast<wide>(x) - mean) * (static_cast<wide>(x) - mean) / count;
    const std::vector<float> found = outputs_of<layer_norm<norm_over::frame>>(frame, epsilon);
    std::size_t outside = 0;
    for (std::size_t e = 0; e < frame.size(); ++e) {
        const wide term = (static_cast<wide>(frame[e]) - mean) /
                          std::sqrt(variance + static_cast<wide>(epsilon)) * static_cast<wide>(scale);
        const auto exact = static_cast<double>(term + static_cast<wide>(shift));
        const double allowed = support::unit_roundoff<float> * std::abs(exact) +
                               0x1p-40 * (std::abs(static_cast<double>(term)) + std::abs(exact));
        outside += !(std::abs(static_cast<double>(found[e]) - exact) <= allowed);
    }
    return outside;
}

/// Values of both signs around a middle, all different.
std::vector<float> frame_of(float middle, float range) {
    std::vector<float> frame;
    for (std::size_t e = 0; e < image.size(); ++e)
        frame.push_back(middle + range * (static_cast<float>(e * 29 % 48) / 24 - 1));
    return frame;
}

} // namespace

TEST_CASE_TEMPLATE("group_norm: a frame without deviation becomes the shift, wherever it lies", Norm,
                   group_norm<2>, instance_norm, layer_norm<norm_over::frame>,
                   layer_norm<norm_over::channels>) {
    for (const float level :
         {0.0F, 1.0F / 3, -255.0F, 123.456F, 1e-40F, 1e30F, std::numeric_limits<float>::max()}) {
        CAPTURE(level);
        for (const float y : outputs_of<Norm>(std::vector<float>(image.size(), level)))
            CHECK(y == shift);
    }
}

TEST_CASE("group_norm: large offsets cost no more than a rounding") {
    CHECK(outputs_outside(frame_of(0, 1)) == 0);
    CHECK(outputs_outside(frame_of(2e4F, 0.125F), 1e-12) == 0);
    CHECK(outputs_outside(frame_of(1e6F, 2)) == 0);
    CHECK(outputs_outside(frame_of(-1e30F, 1e25F)) == 0);
}

TEST_CASE("group_norm: huge and tiny values cost no more than a rounding") {
    CHECK(outputs_outside(frame_of(0, 1e20F)) == 0);
    CHECK(outputs_outside(frame_of(0, std::numeric_limits<float>::max())) == 0);
    CHECK(outputs_outside(frame_of(0, 1e-20F), 1e-12) == 0);
    CHECK(outputs_outside(frame_of(0, 1e-20F), 1e-42) == 0);
    CHECK(outputs_outside(frame_of(0, 1e-40F), 1e-80) == 0);
    // One value alone far away.
    std::vector<float> frame = frame_of(0, 1e-3F);
    frame[7] = 3e38F;
    CHECK(outputs_outside(frame) == 0);
}

TEST_CASE_TEMPLATE("group_norm: a NaN is seen in its sample and in no other", Norm, group_norm<2>,
                   layer_norm<norm_over::frame>, layer_norm<norm_over::channels>) {
    const auto layer = support::make_layer<Norm, float, image>();
    const aligned_vector<float> values(layer->parameters, 1.0F);
    batch<float, image, kernels::lanes<float>> in(3), out(3);
    for (std::size_t s = 0; s < 3; ++s)
        for (std::size_t e = 0; e < image.size(); ++e)
            in(s, e) = static_cast<float>(e * e % 17);
    in(1, 5) = std::nanf("");
    thread_pool threads(1);
    layer->resize(3);
    layer->infer({.threads = threads}, values.data(), nullptr, 3, in.view().data(), out.view().data());
    CHECK(std::isnan(out(1, 5)));
    for (std::size_t e = 0; e < image.size(); ++e)
        for (const std::size_t s : {std::size_t{0}, std::size_t{2}})
            CHECK(!std::isnan(out(s, e)));
}
