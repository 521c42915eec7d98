#include <tactnet/operators/convolution/layer.hpp>

#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

// Kernels of every kind, odd, even, oblong and wider than what stays in registers; filters and channels that
// fill register blocks and that do not; images of one tactel, one line and more.

TEST_CASE("conv2d: kernels of every kind") {
    check_layer<conv2d<1, 1>, shape{1, 1, 1}>();
    check_layer<conv2d<9, 3>, shape{1, 1, 8}>();
    check_layer<conv2d<8, 2>, shape{5, 4, 1}>(); // pads bottom and right
    check_layer<conv2d<9, 3>, shape{7, 13, 3}>();
    check_layer<conv2d<16, 4>, shape{5, 4, 3}>();
    check_layer<conv2d<8, 5>, shape{7, 13, 1}>();
    check_layer<conv2d<22, extent2d{2, 3}>, shape{5, 4, 8}>();
    check_layer<conv2d<5, extent2d{5, 1}>, shape{1, 9, 3}>();
    check_layer<conv2d<5, 7>, shape{7, 6, 3}>(); // over an image no larger
}

// Whose gradients are taken across channels.
TEST_CASE("conv2d: channels that fill vectors of every width") {
    check_layer<conv2d<13, 3>, shape{4, 3, 16}>();
    check_layer<conv2d<2, extent2d{2, 3}, 2>, shape{5, 4, 32}>();
    check_layer<conv2d<3, 3, 1, padding::valid>, shape{4, 5, 48}>();
    check_layer<conv2d<1, extent2d{1, 2}>, shape{3, 40, 16}>(); // rows in several tiles
}
