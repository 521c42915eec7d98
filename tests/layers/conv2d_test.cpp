#include <tactnet/layers/conv2d.hpp>

#include <string>
#include <support/layers/conformance.hpp>
#include <vector>

using namespace tactnet;
using support::check_layer;

TEST_CASE("conv2d: two groups") {
    check_layer<conv2d<6, 3, 1, padding::same, in_groups(2)>, shape{5, 7, 4}>();
}
TEST_CASE("conv2d: two groups whose channels fill vectors, stride 2") {
    check_layer<conv2d<6, 3, 2, pad(1), in_groups(2)>, shape{7, 6, 2 * kernels::lanes<float>}>();
}
TEST_CASE("conv2d: depthwise, without bias") {
    check_layer<conv2d<3, 3, 1, padding::same, conv2d_options{.groups = 3, .bias = false}>, shape{4, 5, 3}>();
}
TEST_CASE("conv2d: depthwise, wider than a register block, stride 2, several filters for each channel") {
    check_layer<conv2d<3, 3, 1, padding::same, in_groups(3)>, shape{4, 13, 3}>();
    check_layer<conv2d<3, 5, 2, padding::same, in_groups(3)>, shape{7, 6, 3}>();
    check_layer<conv2d<4, 3, 1, padding::same, in_groups(2)>, shape{4, 5, 2}>();
}
TEST_CASE("conv2d: without bias") {
    using spec = conv2d<5, 3, 1, padding::valid, without_bias>;
    check_layer<spec, shape{5, 4, 3}>();
    const auto list = support::make_layer<spec, float, shape{5, 4, 3}>()->describe();
    REQUIRE(list.size() == 1);
    CHECK(list[0].name == "layer.weight");
}
TEST_CASE("conv2d: weights of groups are those of their channels") {
    const auto list =
        support::make_layer<conv2d<6, 3, 1, padding::same, in_groups(2)>, float, shape{5, 7, 4}>()
            ->describe();
    CHECK(list[0].extents == std::vector<std::size_t>{6, 2, 3, 3});
}

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
