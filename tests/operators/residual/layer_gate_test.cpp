#include <tactnet/operators.hpp>

#include <string>
#include <support/layers/conformance.hpp>
#include <vector>

using namespace tactnet;
using support::check_layer;

TEST_CASE("gate: squeeze and excitation with a sigmoid and with a hard sigmoid") {
    check_layer<squeeze_excitation<6, 2>, shape{3, 4, 6}>();
    check_layer<squeeze_excitation<5, 3, hard_sigmoid>, shape{4, 3, 5}>();
}
TEST_CASE("gate: the mean of each channel times the channel itself") {
    check_layer<gate<global_average_pool>, shape{3, 5, 2}>();
}
TEST_CASE("gate: a map of one pixel by itself, and by a branch with a batch norm") {
    check_layer<gate<>, shape{1, 1, 4}>();
    check_layer<gate<conv2d<4, 1>, batch_norm, hyperbolic_tangent>, shape{1, 1, 4}>();
}
TEST_CASE("gate: after a layer that needs its output, before one that writes over its input") {
    check_layer<sequence<conv2d<6, 3>, sigmoid, squeeze_excitation<6, 2>, relu, dense<3>>, shape{4, 3, 2}>();
}
TEST_CASE("gate: inside a residual block, as in MobileNetV3") {
    check_layer<residual<sequence<conv2d<6, 1>, hard_swish, squeeze_excitation<6, 2, hard_sigmoid>,
                                  conv2d<3, 1>, batch_norm>>,
                shape{3, 4, 3}>();
}

TEST_CASE("gate: arrays of squeeze and excitation have torchvision's names and extents") {
    CHECK(support::arrays_of<squeeze_excitation<6, 2>, shape{3, 4, 6}>() ==
          std::vector<std::string>{"layer.fc1.weight 2x6x1x1", "layer.fc1.bias 2", "layer.fc2.weight 6x2x1x1",
                                   "layer.fc2.bias 6"});
}
