#include <tactnet/operators/convolution/layer.hpp>

#include <string>
#include <support/layers/conformance.hpp>
#include <vector>

using namespace tactnet;
using support::check_layer;

TEST_CASE("conv2d: groups") {
    check_layer<conv2d<6, 3, 1, padding::same, in_groups(2)>, shape{5, 7, 4}>();
    // Channels that fill vectors.
    check_layer<conv2d<6, 3, 2, pad(1), in_groups(2)>, shape{7, 6, 2 * kernels::lanes<float>}>();
    check_layer<conv2d<3, 3, 1, padding::same, conv2d_options{.groups = 3, .bias = false}>, shape{4, 5, 3}>();
    // Wider than a register block, a stride, several filters for each channel.
    check_layer<conv2d<3, 3, 1, padding::same, in_groups(3)>, shape{4, 13, 3}>();
    check_layer<conv2d<3, 5, 2, padding::same, in_groups(3)>, shape{7, 6, 3}>();
    check_layer<conv2d<4, 3, 1, padding::same, in_groups(2)>, shape{4, 5, 2}>();
}

TEST_CASE("conv2d: without bias") {
    using spec = conv2d<5, 3, 1, padding::valid, without_bias>;
    check_layer<spec, shape{5, 4, 3}>();
    CHECK(support::arrays_of<spec, shape{5, 4, 3}>() == std::vector<std::string>{"layer.weight 5x3x3x3"});
}
TEST_CASE("conv2d: weights of groups are those of their channels") {
    CHECK(support::arrays_of<conv2d<6, 3, 1, padding::same, in_groups(2)>, shape{5, 7, 4}>() ==
          std::vector<std::string>{"layer.weight 6x2x3x3", "layer.bias 6"});
}

// Strides, with 'same' padding: the way back reads the gradient as if zeros stood between its pixels.

TEST_CASE("conv2d: strides") {
    check_layer<conv2d<9, 3, 2>, shape{7, 13, 8}>();
    check_layer<conv2d<8, 1, 2>, shape{5, 4, 3}>(); // a kernel of one leaves pixels unread
    check_layer<conv2d<5, 4, 2>, shape{7, 13, 1}>();
    check_layer<conv2d<8, 3, 3>, shape{7, 13, 3}>();
    check_layer<conv2d<1, extent2d{2, 3}, 3>, shape{7, 13, 1}>();
    check_layer<conv2d<16, 3, extent2d{1, 2}>, shape{5, 4, 3}>();
    check_layer<conv2d<5, 2, 3>, shape{2, 2, 1}>(); // larger than the image
}
