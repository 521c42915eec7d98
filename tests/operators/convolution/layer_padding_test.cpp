#include <tactnet/operators/convolution/layer.hpp>

#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

TEST_CASE("conv2d: padding") {
    check_layer<conv2d<22, 3, 1, padding::valid>, shape{7, 13, 3}>();
    check_layer<conv2d<5, extent2d{5, 4}, 1, padding::valid>, shape{5, 4, 3}>(); // as large as the image
    check_layer<conv2d<8, 4, 3, padding::valid>, shape{8, 13, 1}>(); // the stride leaves rows unread
    check_layer<conv2d<1, 7, 1, padding::valid>, shape{7, 13, 1}>(); // wider than the register block
    check_layer<conv2d<8, 3, 1, pad(1)>, shape{5, 4, 1}>();
    check_layer<conv2d<16, 5, 2, pad(2)>, shape{7, 13, 1}>(); // as in TactResNet
    check_layer<conv2d<5, 1, 1, pad(1)>, shape{5, 4, 3}>();   // windows that see padding alone
    check_layer<conv2d<5, 2, 2, pad(2)>, shape{1, 9, 3}>();   // more padding than the kernel reaches
    check_layer<conv2d<9, 3, 1, pad(0, 1, 2, 0)>, shape{5, 4, 8}>();
    check_layer<conv2d<5, extent2d{3, 2}, 2, pad(0, 1, 2, 0)>, shape{5, 4, 3}>();
    // More padding than the kernel reaches, channels that fill vectors.
    check_layer<conv2d<16, 3, 1, pad(4)>, shape{3, 4, 16}>();
}
