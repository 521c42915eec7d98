#include <tactnet/operators/activations/piecewise.hpp>
#include <tactnet/operators/activations/smooth.hpp>
#include <tactnet/operators/training.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <support/layers/conformance.hpp>

using namespace tactnet;

TEST_CASE_TEMPLATE("activations: what must hold of every layer", Activation, leaky_relu<>, leaky_relu<200>,
                   relu6, hard_sigmoid, hard_swish, sigmoid, silu, hyperbolic_tangent, elu<>, elu<300>,
                   elu<2500>, softplus, gelu) {
    support::check_layer<Activation, shape{5, 4, 3}>();
    support::check_layer<Activation, shape{1, 1, 1}>({.low = -4, .high = 7});
    // After a layer that needs its output, before one that writes over its input.
    support::check_layer<sequence<conv2d<4, 3>, hyperbolic_tangent, Activation, relu, dense<3>>,
                         shape{6, 5, 2}>();
}

TEST_CASE_TEMPLATE("activations: NaN stays NaN, large inputs have the limits as values", Activation,
                   leaky_relu<>, relu6, hard_sigmoid, hard_swish, sigmoid, silu, hyperbolic_tangent, elu<>,
                   elu<300>, softplus, gelu) {
    constexpr float large = std::numeric_limits<float>::max();
    using bound = trained_layer<Activation, float, shape{1, 3, 1}>;
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

namespace {

/// The largest error in units in the last place over floats between −end and end, one in 9973 of them,
/// compared with the function in double.
template <class Function>
double worst_error(float end) {
    using kernels::lanes;
    double worst = 0;
    const auto last = detail::bits_as<std::uint32_t>(end);
    for (std::uint32_t bits = 0; bits <= last; bits += 9973)
        for (const float sign : {-1.0F, 1.0F}) {
            const float x = sign * detail::bits_as<float>(bits);
            alignas(vector_alignment) std::array<float, lanes<float>> found;
            kernels::store(found.data(), Function::value(kernels::vector<float>(x)));
            const double exact = Function::value(static_cast<double>(x));
            const int exponent = exact == 0 ? -126 : std::max(std::ilogb(exact), -126);
            worst = std::max(worst, std::abs(static_cast<double>(found[0]) - exact) /
                                        std::ldexp(1.0, exponent - 23));
        }
    return worst;
}

} // namespace

TEST_CASE("gelu: of infinite numbers, the limits") {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    CHECK(gelu_function::value(infinite) == infinite);
    CHECK(gelu_function::value(-infinite) == 0);
    alignas(vector_alignment) std::array<float, kernels::lanes<float>> above, below;
    constexpr float infinite_float = std::numeric_limits<float>::infinity();
    kernels::store(above.data(), gelu_function::value(kernels::vector<float>(infinite_float)));
    kernels::store(below.data(), gelu_function::value(kernels::vector<float>(-infinite_float)));
    CHECK(above[0] == infinite_float);
    CHECK(below[0] == 0);
}

TEST_CASE("activations: within their units in the last place") {
    CHECK(worst_error<sigmoid_function>(80) <= 3);
    CHECK(worst_error<silu_function>(80) <= 3);
    CHECK(worst_error<hard_sigmoid_function>(80) <= 2);
    CHECK(worst_error<hard_swish_function>(80) <= 3);
    CHECK(worst_error<hyperbolic_tangent_function>(80) <= 2);
    CHECK(worst_error<elu_function<1000>>(80) <= 2);
    CHECK(worst_error<elu_function<300>>(80) <= 3);
    CHECK(worst_error<softplus_function>(80) <= 3);
    CHECK(worst_error<gelu_function>(12) <= 8);
    static_assert(sigmoid_function::value(0.0) == 0.5 && gelu_function::value(0.0) == 0,
                  "tables of networks in 8 bits are made while compiling");
}
