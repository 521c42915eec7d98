#include <tactnet/operators/dilated_convolution/layer.hpp>

#include <cstddef>
#include <support/layers/conformance.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;
using support::check_layer;

TEST_CASE("dilated_conv2d: 'same', at sizes that the dilation divides and does not divide") {
    check_layer<dilated_conv2d<5, 3>, shape{6, 8, 2}>();
    check_layer<dilated_conv2d<4, 3>, shape{7, 5, 3}>();
    check_layer<dilated_conv2d<3, 3, 3>, shape{8, 10, 2}>();
    check_layer<dilated_conv2d<3, extent2d(3, 1), extent2d(2, 4)>, shape{5, 6, 2}>();
}
TEST_CASE("dilated_conv2d: even kernels, whose padding is not the same for all phases") {
    check_layer<dilated_conv2d<3, 2, 3>, shape{7, 8, 2}>();
    check_layer<dilated_conv2d<2, extent2d(2, 4), extent2d(1, 3)>, shape{5, 11, 3}>();
}
TEST_CASE("dilated_conv2d: strides that share a factor with the dilation, or none") {
    check_layer<dilated_conv2d<3, 3, 2, 2>, shape{9, 7, 2}>();
    check_layer<dilated_conv2d<3, 3, 4, 2>, shape{11, 10, 2}>();
    check_layer<dilated_conv2d<3, 3, 2, 3>, shape{11, 13, 2}>();
    check_layer<dilated_conv2d<3, 2, extent2d(3, 2), extent2d(2, 4), pad(2, 1, 0, 3)>, shape{8, 9, 2}>();
}
TEST_CASE("dilated_conv2d: phases that lie side by side where they are deployed") {
    check_layer<dilated_conv2d<5, 3, 4>, shape{14, 13, 3}>();
    check_layer<dilated_conv2d<3, 3, 5, extent2d(1, 3)>, shape{9, 13, 2}>();
}
TEST_CASE("dilated_conv2d: valid, explicit and completed padding; a kernel larger than the map") {
    check_layer<dilated_conv2d<4, 3, 2, 1, padding::valid>, shape{7, 9, 3}>();
    check_layer<dilated_conv2d<4, 3, 2, 1, pad(2, 0, 1, 3)>, shape{4, 5, 3}>();
    check_layer<dilated_conv2d<3, 3, 2, 2, ceil_mode(pad(1))>, shape{8, 6, 2}>();
    check_layer<dilated_conv2d<3, 3, 3>, shape{4, 2, 2}>();
    check_layer<dilated_conv2d<3, 3, 5>, shape{1, 1, 2}>();
}
TEST_CASE("dilated_conv2d: in groups, depthwise, without bias") {
    check_layer<dilated_conv2d<6, 3, 2, 1, padding::same, in_groups(2)>, shape{5, 7, 4}>();
    check_layer<dilated_conv2d<6, 3, 2, 1, padding::same, in_groups(6)>, shape{6, 5, 6}>();
    check_layer<dilated_conv2d<4, 3, 2, 1, padding::same, without_bias>, shape{5, 5, 3}>();
}
TEST_CASE("dilated_conv2d: in a list, one after the other, in place of what is overwritten") {
    check_layer<sequence<conv2d<5, 3>, relu, dilated_conv2d<4, 3>, batch_norm, relu, dilated_conv2d<3, 3, 4>,
                         max_pool<2>, dense<3>>,
                shape{9, 11, 2}>();
}

TEST_CASE("dilated_conv2d: a dilation of 1 is the convolution") {
    using dilated = dilated_conv2d<3, 3, 1, 2, pad(1, 0, 2, 1), in_groups(3)>;
    using plain = conv2d<3, 3, 2, pad(1, 0, 2, 1), in_groups(3)>;
    static_assert(dilated::costs({8, 9, 6}) == plain::costs({8, 9, 6}));
    check_layer<dilated, shape{8, 9, 6}>();
}

// A 3 × 3 kernel over 5 × 5 pixels: each axis has 5 outputs, whose taps lie at −2, 0 and 2: 3 + 5 + 3 pixels.
static_assert(dilated_conv2d<7, 3>::costs({5, 5, 4}) == layer_costs{.output = {5, 5, 7},
                                                                    .parameters = 7 * 4 * 9 + 7,
                                                                    .multiply_adds = 25 * 7 * 4 * 9,
                                                                    .multiply_adds_on_pixels = 11 * 11 * 28});
static_assert(dilated_conv2d<7, 3, 2, 1, padding::valid>::costs({28, 50, 1}).output == shape{24, 46, 7});

// Neighbouring phases share their zeros: two phases of 14 rows with 1 zero before, between and after them.
// Those at the edges are padding.
static_assert(kernels::dilated_axis::of(28, 28, 3, 2, 1, 2).pixels() == 2 * 14 + 1);
static_assert(kernels::dilated_axis::of(28, 28, 3, 2, 1, 2).zeros_before == 1);
static_assert(kernels::dilated_axis::of(28, 28, 3, 2, 1, 2).zeros_after == 1);
static_assert(kernels::dilated_axis::of(28, 28, 3, 2, 1, 2).sum_of(27) == 28);
// Without padding they are side by side.
static_assert(kernels::dilated_axis::of(28, 24, 3, 2, 1, 0).pixels() == 28);
