#include <tactnet/layers/activations/softmax.hpp>

#include <cmath>
#include <support/layers/conformance.hpp>
#include <vector>

using namespace tactnet;
using support::check_layer;

TEST_CASE("softmax: logits") {
    check_layer<softmax, shape{1, 1, 22}>();
}
TEST_CASE("softmax: over the channels of every pixel") {
    check_layer<softmax, shape{2, 3, 4}>();
}
TEST_CASE("softmax: a single class") {
    check_layer<softmax, shape{1, 1, 1}>();
}

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
