#include <tactnet/layers/normalisation/batch_norm.hpp>
#include <tactnet/runtime/random.hpp>

#include <cmath>
#include <support/layers/conformance.hpp>
#include <vector>

using namespace tactnet;
using support::check_layer;

TEST_CASE("batch_norm: images") {
    check_layer<batch_norm, shape{5, 4, 3}>();
}
TEST_CASE("batch_norm: more values than one run of a sum") {
    check_layer<batch_norm, shape{7, 13, 2}>();
}
TEST_CASE("batch_norm: one tactel") {
    check_layer<batch_norm, shape{1, 1, 5}>();
}
TEST_CASE("batch_norm: the paper's epsilon") {
    check_layer<batch_norm, shape{5, 4, 1}>({.epsilon = 1e-4});
}
// Single precision holds such values to 5e-4 only, but what is made of the values that it holds is accurate.
TEST_CASE("batch_norm: a mean of ten thousand, a deviation of a hundredth") {
    check_layer<batch_norm, shape{5, 4, 3}>({.low = 1e4 - 2e-2, .high = 1e4 + 2e-2});
}

namespace {

using bound = batch_norm::layer<float, shape{3, 2, 2}>;
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
    using single = batch_norm::layer<float, shape{1, 1, 1}>;
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
