#include <tactnet/operators/pooling/layer.hpp>

#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

TEST_CASE("upsample: nearest, by one factor and by another for rows and columns") {
    check_layer<upsample<2>, shape{3, 5, 3}>();
    check_layer<upsample<extent2d{1, 3}>, shape{4, 3, 2}>();
}
TEST_CASE("upsample: bilinear, by one factor and by another for rows and columns") {
    check_layer<upsample<2, interpolation::bilinear>, shape{3, 5, 3}>();
    check_layer<upsample<extent2d{3, 1}, interpolation::bilinear>, shape{4, 3, 2}>();
    check_layer<upsample<4, interpolation::bilinear>, shape{1, 2, 1}>();
}
TEST_CASE("upsample_to: larger, smaller, and the size that the map has") {
    check_layer<upsample_to<extent2d{7, 13}>, shape{4, 5, 2}>();
    check_layer<upsample_to<extent2d{7, 13}, interpolation::bilinear>, shape{4, 5, 2}>();
    check_layer<upsample_to<extent2d{3, 4}>, shape{7, 9, 1}>();
    check_layer<upsample_to<extent2d{3, 4}, interpolation::bilinear>, shape{7, 9, 1}>();
    check_layer<upsample_to<extent2d{4, 6}, interpolation::bilinear>, shape{4, 6, 2}>();
}
TEST_CASE("upsample: in a list, between convolutions") {
    check_layer<sequence<conv2d<5, 3>, relu, upsample<2, interpolation::bilinear>, relu, conv2d<3, 3>>,
                shape{4, 3, 2}>();
}

// PyTorch: nn.Upsample(scale_factor=2, mode='bilinear') of 1, 5 gives 1, 2, 4, 5.
using twice = kernels::sampling_axis<interpolation::bilinear, 2, 4>;
static_assert(twice::table[0].weights[0] == 1 && twice::table[1].weights[0] == 0.75 &&
              twice::table[1].weights[1] == 0.25 && twice::table[2].weights[0] == 0.25 &&
              twice::table[3].weights[1] == 1);
static_assert(upsample<extent2d{2, 3}>::costs({5, 7, 4}) == layer_costs{.output = {10, 21, 4}});
