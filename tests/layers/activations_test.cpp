#include <tactnet/layers/activations/gelu.hpp>
#include <tactnet/layers/activations/hard.hpp>
#include <tactnet/layers/activations/hyperbolic_tangent.hpp>
#include <tactnet/layers/activations/leaky_relu.hpp>
#include <tactnet/layers/activations/sigmoid.hpp>
#include <tactnet/layers/activations/softplus.hpp>

#include <cmath>
#include <limits>
#include <support/layers/conformance.hpp>

using namespace tactnet;

TEST_CASE_TEMPLATE("activations: what must hold of every layer", Activation, leaky_relu<>, leaky_relu<200>,
                   relu6, hard_sigmoid, hard_swish, sigmoid, silu, hyperbolic_tangent, softplus, gelu) {
    support::check_layer<Activation, shape{5, 4, 3}>();
    support::check_layer<Activation, shape{1, 1, 1}>({.low = -4, .high = 7});
    // After a layer that needs its output, before one that writes over its input.
    support::check_layer<sequence<conv2d<4, 3>, hyperbolic_tangent, Activation, relu, dense<3>>,
                         shape{6, 5, 2}>();
}

TEST_CASE_TEMPLATE("activations: NaN stays NaN, large inputs have the limits as values", Activation,
                   leaky_relu<>, relu6, hard_sigmoid, hard_swish, sigmoid, silu, hyperbolic_tangent, softplus,
                   gelu) {
    constexpr float large = std::numeric_limits<float>::max();
    using bound = typename Activation::template layer<float, shape{1, 3, 1}>;
    batch<float, shape{1, 3, 1}, kernels::lanes<float>> in(1), out(1);
    in(0, 0) = std::numeric_limits<float>::quiet_NaN(), in(0, 1) = large, in(0, 2) = -large;
    thread_pool threads;
    no_memory none;
    bound::infer({.threads = threads}, nullptr, nullptr, none, in.view(), out.view());
    CHECK(std::isnan(out(0, 0)));
    const auto limit = support::reference_of<Activation>::on({1, 3, 1});
    const support::samples exact = limit->forward({}, {{{0}, {1e6}, {-1e6}}});
    const double above = exact[0][1].value, below = exact[0][2].value;
    CHECK(out(0, 1) == (above > 100 ? large : static_cast<float>(above)));
    if (below > -100)
        CHECK(out(0, 2) == static_cast<float>(below));
}
