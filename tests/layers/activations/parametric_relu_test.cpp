#include <tactnet/layers/activations/parametric_relu.hpp>

#include <cmath>
#include <limits>
#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

TEST_CASE("parametric_relu: what must hold of every layer, at sizes that fill no vector") {
    check_layer<parametric_relu, shape{5, 4, 3}>();
    check_layer<parametric_relu, shape{1, 1, 1}>();
    check_layer<parametric_relu, shape{7, 6, 2}>({.low = -4, .high = 1});
}
TEST_CASE("parametric_relu: in a list, after a layer and before one that write over their inputs") {
    check_layer<sequence<conv2d<4, 3>, relu, parametric_relu, relu, dense<3>>, shape{6, 5, 2}>();
    check_layer<sequence<conv2d<4, 3>, batch_norm, parametric_relu, max_pool<2>, dense<3>>, shape{6, 5, 2}>();
}
TEST_CASE("parametric_relu: NaN stays NaN") {
    using bound = parametric_relu::layer<float, shape{1, 3, 1}>;
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
