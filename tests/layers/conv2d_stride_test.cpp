#include <tactnet/layers/conv2d.hpp>

#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

// Strides, with 'same' padding: the way back reads the gradient as if zeros stood between its pixels.

TEST_CASE("conv2d: stride 2") {
    check_layer<conv2d<9, 3, 2>, shape{7, 13, 8}>();
}
TEST_CASE("conv2d: stride 2 of a kernel of one leaves pixels unread") {
    check_layer<conv2d<8, 1, 2>, shape{5, 4, 3}>();
}
TEST_CASE("conv2d: stride 2 of an even kernel") {
    check_layer<conv2d<5, 4, 2>, shape{7, 13, 1}>();
}
TEST_CASE("conv2d: stride 3") {
    check_layer<conv2d<8, 3, 3>, shape{7, 13, 3}>();
}
TEST_CASE("conv2d: stride 3 of an oblong kernel") {
    check_layer<conv2d<1, extent2d{2, 3}, 3>, shape{7, 13, 1}>();
}
TEST_CASE("conv2d: stride 1 × 2") {
    check_layer<conv2d<16, 3, extent2d{1, 2}>, shape{5, 4, 3}>();
}
TEST_CASE("conv2d: stride larger than the image") {
    check_layer<conv2d<5, 2, 3>, shape{2, 2, 1}>();
}
