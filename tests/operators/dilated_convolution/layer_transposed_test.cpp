#include <tactnet/operators/dilated_convolution/layer.hpp>

#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

TEST_CASE("transposed_conv2d: kernels of the stride's size, side by side") {
    check_layer<transposed_conv2d<5, 2>, shape{3, 4, 2}>();
    check_layer<transposed_conv2d<3, extent2d{1, 3}>, shape{4, 2, 5}>();
}
TEST_CASE("transposed_conv2d: kernels that overlap, cropped as PyTorch does, and kernels that leave gaps") {
    check_layer<transposed_conv2d<4, 3, 2, pad(1, 0, 1, 0)>, shape{3, 5, 3}>();
    check_layer<transposed_conv2d<3, extent2d{4, 5}, 2, pad(1, 2, 3, 0)>, shape{4, 3, 2}>();
    check_layer<transposed_conv2d<2, 3, 2, padding::valid>, shape{3, 4, 9}>();
    check_layer<transposed_conv2d<3, 2, extent2d{3, 4}>, shape{3, 2, 2}>();
}
TEST_CASE("transposed_conv2d: 'same' with kernels larger than the stride") {
    check_layer<transposed_conv2d<8, 4, 2>, shape{3, 3, 8}>();
    check_layer<transposed_conv2d<3, 5, extent2d{3, 2}>, shape{2, 5, 2}>();
}
TEST_CASE("transposed_conv2d: stride 1, without bias, one pixel") {
    check_layer<transposed_conv2d<6, 3, 1, padding::same, false>, shape{5, 6, 4}>();
    check_layer<transposed_conv2d<3, 2, 1, padding::valid>, shape{4, 5, 2}>();
    check_layer<transposed_conv2d<4, 3, 2, padding::same, false>, shape{1, 1, 3}>();
}
TEST_CASE("transposed_conv2d: in a list, after a convolution with a stride") {
    check_layer<sequence<conv2d<5, 3, 2>, relu, transposed_conv2d<4, 4, 2>, batch_norm, relu>,
                shape{6, 4, 2}>();
}
static_assert(transposed_conv2d<5, 3, 2, pad(1, 0, 1, 0)>::costs({3, 4, 2}).output == shape{6, 8, 5});
static_assert(transposed_conv2d<5, 3, 2, padding::valid>::costs({3, 4, 2}) ==
              layer_costs{.output = {7, 9, 5},
                          .parameters = 2 * 5 * 9 + 5,
                          .multiply_adds = 12 * 90,
                          .multiply_adds_on_pixels = 12 * 90});
