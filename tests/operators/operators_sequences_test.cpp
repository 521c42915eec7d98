#include <tactnet/operators.hpp>

#include <string>
#include <support/layers/conformance.hpp>
#include <vector>

using namespace tactnet;
using support::arrays_of;
using support::check_layer;
using texts = std::vector<std::string>;

TEST_CASE("causal_conv1d: what must hold of every layer") {
    check_layer<causal_conv1d<5, 3>, shape{7, 1, 3}>();
    check_layer<causal_conv1d<4, 2, 3>, shape{9, 1, 5}>();
    check_layer<causal_conv1d<1, 1>, shape{1, 1, 1}>();
    // Taps that lie before the first frame for every output.
    check_layer<causal_conv1d<17, 4, 2>, shape{3, 1, 2}>();
    check_layer<sequence<causal_conv1d<6, 3>, relu, residual<causal_conv1d<6, 3, 2>>, last_frame, dense<3>>,
                shape{8, 1, 2}>();
}
TEST_CASE("causal_conv1d: names and extents are those of PyTorch's Conv1d") {
    CHECK(arrays_of<sequence<causal_conv1d<5, 3>>, shape{7, 1, 2}>() ==
          texts{"layer.conv1.weight 5x2x3", "layer.conv1.bias 5"});
}
TEST_CASE("last_frame: what must hold of every layer") {
    check_layer<last_frame, shape{4, 1, 3}>();
    check_layer<last_frame, shape{1, 1, 1}>();
}

TEST_CASE("gru: what must hold of every layer") {
    check_layer<gru<5>, shape{7, 1, 3}>();
    check_layer<gru<1>, shape{1, 1, 1}>();
    check_layer<gru<19>, shape{3, 1, 17}>();
    check_layer<sequence<gru<6>, gru<4>, last_frame, dense<3>>, shape{5, 1, 4}>();
}
TEST_CASE("gru: names and extents are PyTorch's") {
    CHECK(arrays_of<sequence<gru<5>, last_frame, dense<2>>, shape{7, 1, 3}>() ==
          texts{"layer.gru.weight_ih_l0 15x3", "layer.gru.weight_hh_l0 15x5", "layer.gru.bias_ih_l0 15",
                "layer.gru.bias_hh_l0 15", "layer.fc.weight 2x5", "layer.fc.bias 2"});
}

TEST_CASE("lstm: what must hold of every layer") {
    check_layer<lstm<5>, shape{7, 1, 3}>();
    check_layer<lstm<1>, shape{1, 1, 1}>();
    check_layer<lstm<18>, shape{3, 1, 19}>();
    check_layer<sequence<lstm<4>, relu, lstm<3>, last_frame>, shape{4, 1, 2}>();
}
TEST_CASE("lstm: names and extents are PyTorch's") {
    CHECK(arrays_of<sequence<lstm<5>, lstm<2>>, shape{7, 1, 3}>() ==
          texts{"layer.lstm1.weight_ih_l0 20x3", "layer.lstm1.weight_hh_l0 20x5", "layer.lstm1.bias_ih_l0 20",
                "layer.lstm1.bias_hh_l0 20", "layer.lstm2.weight_ih_l0 8x5", "layer.lstm2.weight_hh_l0 8x2",
                "layer.lstm2.bias_ih_l0 8", "layer.lstm2.bias_hh_l0 8"});
}
