#include <tactnet/operators.hpp>

#include <string>
#include <support/layers/conformance.hpp>
#include <vector>

// Names and extents of the arrays of operators, which are those of PyTorch, torchvision and timm.

using namespace tactnet;
using support::arrays_of;
using texts = std::vector<std::string>;

TEST_CASE("conv2d: without bias") {
    using spec = conv2d<5, 3, 1, padding::valid, without_bias>;
    CHECK(arrays_of<spec, shape{5, 4, 3}>() == texts{"layer.weight 5x3x3x3"});
}
TEST_CASE("conv2d: weights of groups are those of their channels") {
    CHECK(arrays_of<conv2d<6, 3, 1, padding::same, in_groups(2)>, shape{5, 7, 4}>() ==
          texts{"layer.weight 6x2x3x3", "layer.bias 6"});
}
TEST_CASE("gate: arrays of squeeze and excitation have torchvision's names and extents") {
    CHECK(arrays_of<squeeze_excitation<6, 2>, shape{3, 4, 6}>() ==
          texts{"layer.fc1.weight 2x6x1x1", "layer.fc1.bias 2", "layer.fc2.weight 6x2x1x1",
                "layer.fc2.bias 6"});
}
TEST_CASE("channel_scale: its array has timm's name") {
    CHECK(arrays_of<channel_scale, shape{3, 4, 6}>() == texts{"layer.gamma 6"});
    const auto arrays = support::make_layer<channel_scale, float, shape{3, 4, 6}>()->describe();
    CHECK(arrays[0].role == parameter_role::scale);
}
TEST_CASE("group_norm: arrays have PyTorch's names and extents") {
    const auto arrays = support::make_layer<group_norm<2>, float, shape{3, 4, 6}>()->describe();
    CHECK(arrays_of<group_norm<2>, shape{3, 4, 6}>() == texts{"layer.weight 6", "layer.bias 6"});
    CHECK(arrays[0].role == parameter_role::scale);
    CHECK(arrays[1].role == parameter_role::shift);
}
TEST_CASE("layer_norm: arrays have PyTorch's extents") {
    CHECK(arrays_of<layer_norm<norm_over::frame>, shape{3, 4, 6}>() ==
          texts{"layer.weight 6x3x4", "layer.bias 6x3x4"});
    CHECK(arrays_of<layer_norm<norm_over::channels>, shape{3, 4, 6}>() ==
          texts{"layer.weight 6", "layer.bias 6"});
}

TEST_CASE("causal_conv1d: names and extents are those of PyTorch's Conv1d") {
    CHECK(arrays_of<sequence<causal_conv1d<5, 3>>, shape{7, 1, 2}>() ==
          texts{"layer.conv1.weight 5x2x3", "layer.conv1.bias 5"});
}
TEST_CASE("gru: names and extents are PyTorch's") {
    CHECK(arrays_of<sequence<gru<5>, last_frame, dense<2>>, shape{7, 1, 3}>() ==
          texts{"layer.gru.weight_ih_l0 15x3", "layer.gru.weight_hh_l0 15x5", "layer.gru.bias_ih_l0 15",
                "layer.gru.bias_hh_l0 15", "layer.fc.weight 2x5", "layer.fc.bias 2"});
}
TEST_CASE("lstm: names and extents are PyTorch's") {
    CHECK(arrays_of<sequence<lstm<5>, lstm<2>>, shape{7, 1, 3}>() ==
          texts{"layer.lstm1.weight_ih_l0 20x3", "layer.lstm1.weight_hh_l0 20x5", "layer.lstm1.bias_ih_l0 20",
                "layer.lstm1.bias_hh_l0 20", "layer.lstm2.weight_ih_l0 8x5", "layer.lstm2.weight_hh_l0 8x2",
                "layer.lstm2.bias_ih_l0 8", "layer.lstm2.bias_hh_l0 8"});
}
