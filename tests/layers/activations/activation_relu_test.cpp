#include <tactnet/layers/activations/activation.hpp>

#include <cmath>
#include <limits>
#include <support/layers/conformance.hpp>

using namespace tactnet;

TEST_CASE("relu: images") {
    support::check_layer<relu, shape{5, 4, 3}>();
}
TEST_CASE("relu: one tactel") {
    support::check_layer<relu, shape{1, 1, 1}>();
}

TEST_CASE("relu: zeros of both signs, infinities and NaN") {
    using bound = relu::layer<float, shape{1, 6, 1}>;
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
