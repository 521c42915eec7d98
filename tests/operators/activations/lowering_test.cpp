#include "../../deployment/deployed_network.hpp"
#include "../../deployment/eight_bit/networks.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <deployment/export/softsign.hpp>

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
template <unsigned Hundredths>
struct support::reference_of<own::softsign<Hundredths>> {
    static constexpr double c = Hundredths / 100.0;
    static reference_pointer on(extents3 in) {
        return reference_activation(in,
                                    {[](double x) { return x / (c + std::abs(x)); },
                                     [](double x) { return c / std::pow(c + std::abs(x), 2); }, 3, 6, 1 / c});
    }
};

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

TEST_CASE("deployed: a function of vectors that is defined outside the library is fused, without the pool") {
    using net = network<shape{7, 9, 2}, conv2d<5, 3>, own::softsign<50>, max_pool<2>, conv2d<16, 3>,
                        max_pool<2>, own::softsign<120>, dense<4>>;
    static_assert(!fused<own::softsign_function<50>>->in_registers &&
                  !fused<own::softsign_function<50>>->monotonic);
    using steps = lowered_network<net>::step;
    static_assert(steps::size == 4 && steps::at<0>::kernel.activation == fused<own::softsign_function<50>> &&
                  steps::at<2>::kernel.activation == fused<own::softsign_function<120>>);
    CHECK(support::errors_of<net>(59, 5));
    CHECK(support::frames_that_differ<net>(60, 10) == 0);
}

TEST_CASE("deployed: activations after sums of two branches, phases, slices and pools that maps cut") {
    using sums =
        network<shape{7, 9, 2}, conv2d<6, 3>, residual<sequence<conv2d<9, 3>, relu, conv2d<6, 3>>>, silu,
                residual<sequence<conv2d<20, 3>, batch_norm>, sequence<conv2d<20, 1>>>, silu, dense<4>>;
    static_assert(lowered_network<sums>::step::size == 4);
    CHECK(support::errors_of<sums>(61, 5));
    using phases = network<shape{4, 5, 2}, conv2d<6, 3>, transposed_conv2d<5, 3, extent2d(2, 1)>, batch_norm,
                           silu, transposed_conv2d<3, 2, 2>, silu, dense<4>>;
    CHECK(support::errors_of<phases>(62, 5));
    using slices = network<shape{7, 6, 3},
                           concatenation<sequence<conv2d<16, 1>, silu>, sequence<conv2d<5, 3>, gelu>,
                                         sequence<conv2d<32, 3>, silu>, sequence<conv2d<4, 3>, relu>>,
                           dense<4>>;
    CHECK(support::errors_of<slices>(63, 5));
    using cut =
        network<shape{9, 11, 2}, conv2d<6, 3>, max_pool<extent2d(2, 3)>, silu, conv2d<6, 3>, leaky_relu<>,
                max_pool<2>, conv2d<5, 2>, max_pool<2, 2, padding::valid>, gelu, dense<4>>;
    CHECK(support::errors_of<cut>(64, 5));
}

TEST_CASE("deployed: activations in 8 bits give the bits of the plain reference") {
    CHECK(support::frames_that_differ<smooth>(53, 10) == 0);
    CHECK(support::frames_that_differ<clamped>(54, 10) == 0);
    CHECK(support::frames_that_differ<sloped>(56, 10) == 0);
}
