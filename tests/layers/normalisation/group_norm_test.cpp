#include <tactnet/layers/normalisation/group_norm.hpp>

#include <string>
#include <support/layers/conformance.hpp>
#include <vector>

using namespace tactnet;
using support::check_layer;

TEST_CASE("group_norm: two groups of three channels") {
    check_layer<group_norm<2>, shape{3, 4, 6}>();
}
TEST_CASE("group_norm: one group, more values than one run of a sum") {
    check_layer<group_norm<1>, shape{7, 5, 2}>();
}
TEST_CASE("group_norm: images of one pixel") {
    check_layer<group_norm<2>, shape{1, 1, 6}>();
}
TEST_CASE("group_norm: the network's epsilon") {
    check_layer<group_norm<3>, shape{2, 3, 3}>({.epsilon = 1e-2});
}
// Single precision holds such values to 5e-4 only, but what is made of the values that it holds is accurate.
TEST_CASE("group_norm: a mean of ten thousand, a deviation of a hundredth") {
    check_layer<group_norm<2>, shape{3, 4, 4}>({.low = 1e4 - 2e-2, .high = 1e4 + 2e-2});
}
TEST_CASE("group_norm: between layers that work by parts, before one that writes over its input") {
    check_layer<sequence<conv2d<4, 3>, group_norm<2>, relu, conv2d<6, 2>, group_norm<3>, dense<3>>,
                shape{4, 3, 2}>();
}
TEST_CASE("instance_norm: each channel by itself") {
    check_layer<instance_norm, shape{4, 3, 5}>();
}

TEST_CASE("group_norm: arrays have PyTorch's names and extents") {
    const auto arrays = support::make_layer<group_norm<2>, float, shape{3, 4, 6}>()->describe();
    REQUIRE(arrays.size() == 2);
    CHECK(arrays[0].name == "layer.weight");
    CHECK(arrays[1].name == "layer.bias");
    CHECK(arrays[0].extents == std::vector<std::size_t>{6});
    CHECK(arrays[0].role == parameter_role::scale);
    CHECK(arrays[1].role == parameter_role::shift);
}
