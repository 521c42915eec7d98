#include "../deployed_network.hpp"
#include "../eight_bit/networks.hpp"

#include <doctest/doctest.h>

using namespace tactnet;

namespace own {

/// A ReLU of a user, with the members that activation_function.hpp asks for.
struct relu_function {
    static constexpr const char *name = "own_relu", *title = "Own ReLU", *type = "own::relu_function",
                                *header = "";
    static constexpr bool is_relu = true;

    template <class T>
    static constexpr T value(T x) {
        return x < 0 ? T(0) : x;
    }
    template <class T>
    static constexpr T backward(T y, T gradient) {
        return y > 0 ? gradient : T(0);
    }
};

using relu = activation<relu_function>;

} // namespace own

template <>
struct support::reference_of<own::relu> : reference_of<relu> {};

namespace {

/// Between convolutions and after other activations, at sizes that fill no vector.
using smooth = network<shape{7, 9, 2}, conv2d<5, 3>, silu, conv2d<6, 3>, batch_norm, gelu, max_pool<2>,
                       conv2d<3, 2>, softplus, hyperbolic_tangent, sigmoid, dense<4>>;
using clamped = network<shape{5, 6, 3}, conv2d<7, 3>, hard_swish, conv2d<6, 3>, batch_norm, relu6,
                        conv2d<3, 2>, leaky_relu<>, hard_sigmoid, conv2d<9, 1>, elu<>, conv2d<4, 2>, elu<300>,
                        leaky_relu<200>, dense<4>>;
using sloped = network<shape{7, 9, 2}, conv2d<5, 3>, parametric_relu, conv2d<16, 3>, batch_norm,
                       parametric_relu, max_pool<2>, conv2d<33, 2>, parametric_relu, dense<4>>;

} // namespace

TEST_CASE("deployed: activations within the derived bound") {
    CHECK(support::errors_of<smooth>(51, 5));
    CHECK(support::errors_of<clamped>(52, 5));
    CHECK(support::errors_of<sloped>(55, 5));
}

TEST_CASE("deployed: a ReLU that is defined outside the library is fused, with the pool after it") {
    using net =
        network<shape{7, 9, 2}, conv2d<5, 3>, own::relu, max_pool<2>, conv2d<16, 3>, own::relu, dense<4>>;
    static_assert(fused<own::relu_function>->in_registers && fused<own::relu_function>->monotonic);
    CHECK(support::errors_of<net>(57, 5));
    CHECK(support::frames_that_differ<net>(58, 10) == 0);
}

TEST_CASE("deployed: activations in 8 bits give the bits of the plain reference") {
    CHECK(support::frames_that_differ<smooth>(53, 10) == 0);
    CHECK(support::frames_that_differ<clamped>(54, 10) == 0);
    CHECK(support::frames_that_differ<sloped>(56, 10) == 0);
}
