#include <tactnet/operators/training.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <support/layers/conformance.hpp>
#include <utility>
#include <vector>

using namespace tactnet;

TEST_CASE("relu: zeros of both signs, infinities and NaN") {
    using bound = trained_layer<relu, float, shape{1, 6, 1}>;
    constexpr float infinite = std::numeric_limits<float>::infinity();
    batch<float, shape{1, 6, 1}, kernels::lanes<float>> in(1), out(1), out_gradient(1), in_gradient(1);
    const float given[] = {-0.0f, 0.0f, -infinite, infinite, std::nanf(""), -1e-40f};
    for (std::size_t e = 0; e < 6; ++e)
        in(0, e) = given[e], out_gradient(0, e) = 1;
    thread_pool threads;
    no_memory none;
    bound::infer({.threads = threads}, nullptr, nullptr, none, in.view(), out.view());
    CHECK(out(0, 0) == 0);
    CHECK(out(0, 1) == 0);
    CHECK(out(0, 2) == 0);
    CHECK(out(0, 3) == infinite);
    CHECK(std::isnan(out(0, 4)));
    CHECK(out(0, 5) == 0);
    bound::backward({.threads = threads}, nullptr, none, in.view(), out.as_const(), out_gradient.as_const(),
                    in_gradient.view(), nullptr);
    for (std::size_t e = 0; e < 6; ++e)
        CHECK(in_gradient(0, e) == (e == 3 ? 1 : 0)); // none at zero itself
}

TEST_CASE("parametric_relu: NaN stays NaN") {
    using bound = trained_layer<parametric_relu, float, shape{1, 3, 1}>;
    batch<float, shape{1, 3, 1}, kernels::lanes<float>> in(1), out(1);
    in(0, 0) = std::numeric_limits<float>::quiet_NaN(), in(0, 1) = -3, in(0, 2) = 5;
    thread_pool threads;
    bound::memory memory;
    const float slope = -0.5f;
    bound::infer({.threads = threads}, &slope, nullptr, memory, in.view(), out.view());
    CHECK(std::isnan(out(0, 0)));
    CHECK(out(0, 1) == 1.5f);
    CHECK(out(0, 2) == 5);
}
static_assert(parametric_relu::costs({5, 7, 4}) == layer_costs{.output = {5, 7, 4}, .parameters = 4});

TEST_CASE("softmax_of: equal logits, and logits far apart") {
    std::vector<float> p(4);
    kernels::softmax_of<float>(std::vector<float>{1e4f, 1e4f, 1e4f, 1e4f}, p);
    for (const float each : p)
        CHECK(each == 0.25f);
    kernels::softmax_of<float>(std::vector<float>{-1e4f, 1e4f, 0, -1e30f}, p);
    CHECK(p == std::vector<float>{0, 1, 0, 0});
    kernels::softmax_of<float>(std::vector<float>{-1e4f, -1e4f - 1, -1e4f - 1, -3e38f}, p);
    CHECK(p[0] == doctest::Approx(1 / (1 + 2 * std::exp(-1.0))));
    CHECK(p[1] == doctest::Approx(std::exp(-1.0) / (1 + 2 * std::exp(-1.0))));
    CHECK(p[3] == 0);
}

TEST_CASE("softmax_of: in place") {
    std::vector<double> p{0, std::log(3.0)};
    kernels::softmax_of<double>(p, p);
    CHECK(p[0] == doctest::Approx(0.25));
    CHECK(p[1] == doctest::Approx(0.75));
}

TEST_CASE("softmax_of: NaN is not hidden") {
    std::vector<float> p(3);
    kernels::softmax_of<float>(std::vector<float>{1, std::nanf(""), 2}, p);
    for (const float each : p)
        CHECK(std::isnan(each));
}

// √(x + o) − √o would lose all digits of x where it is far smaller than o.
TEST_CASE("square_root: small inputs keep their digits, zero stays zero, NaN stays NaN") {
    constexpr std::size_t count = 64; // whole vectors of any instruction set
    alignas(vector_alignment) std::array<float, count> in{}, out{};
    in[1] = 1e-12F, in[2] = -1.0F, in[3] = std::numeric_limits<float>::quiet_NaN(), in[4] = -0.0F;
    constexpr float offset = 0.25F;
    kernels::transform_vectors(kernels::shifted_root(offset), count, out.data(), std::as_const(in).data());
    CHECK(out[0] == 0);
    // Two roots, a sum and a quotient, each rounded once, and the sum with the offset: five roundings.
    CHECK(std::abs(static_cast<double>(out[1]) - 1e-12) <= 6 * 0x1p-24 * 1e-12);
    CHECK(out[2] == 0);
    CHECK(std::isnan(out[3]));
    CHECK(out[4] == 0);
}
