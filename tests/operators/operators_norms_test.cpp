#include <tactnet/operators.hpp>
#include <tactnet/operators/batch_norm/layer.hpp>
#include <tactnet/operators/sample_norms/layer.hpp>

#include <string>
#include <support/layers/conformance.hpp>
#include <vector>

using namespace tactnet;
using support::arrays_of;
using support::check_layer;
using texts = std::vector<std::string>;

TEST_CASE("channel_scale: images, more values than one run of a sum, and one pixel") {
    check_layer<channel_scale, shape{3, 4, 5}>();
    check_layer<channel_scale, shape{7, 5, 2}>();
    check_layer<channel_scale, shape{1, 1, 3}>();
}
TEST_CASE("channel_scale: at the end of a residual block, as in ConvNeXt") {
    check_layer<
        residual<sequence<conv2d<3, 3, 1, padding::same, in_groups(3)>, layer_norm<norm_over::channels>,
                          conv2d<6, 1>, gelu, conv2d<3, 1>, channel_scale>>,
        shape{3, 4, 3}>();
}
TEST_CASE("channel_scale: its array has timm's name") {
    CHECK(arrays_of<channel_scale, shape{3, 4, 6}>() == texts{"layer.gamma 6"});
    const auto arrays = support::make_layer<channel_scale, float, shape{3, 4, 6}>()->describe();
    CHECK(arrays[0].role == parameter_role::scale);
}

TEST_CASE("group_norm: what must hold of every layer") {
    check_layer<group_norm<2>, shape{3, 4, 6}>();
    check_layer<group_norm<1>, shape{7, 5, 2}>(); // more values than one run of a sum
    check_layer<group_norm<2>, shape{1, 1, 6}>();
    check_layer<group_norm<3>, shape{2, 3, 3}>({.epsilon = 1e-2});
    // Single precision holds such values to 5e-4 only, but what is made of the values that it holds is
    // accurate.
    check_layer<group_norm<2>, shape{3, 4, 4}>({.low = 1e4 - 2e-2, .high = 1e4 + 2e-2});
    // Between layers that work by parts, before one that writes over its input.
    check_layer<sequence<conv2d<4, 3>, group_norm<2>, relu, conv2d<6, 2>, group_norm<3>, dense<3>>,
                shape{4, 3, 2}>();
    check_layer<instance_norm, shape{4, 3, 5}>();
}

TEST_CASE("group_norm: arrays have PyTorch's names and extents") {
    const auto arrays = support::make_layer<group_norm<2>, float, shape{3, 4, 6}>()->describe();
    CHECK(arrays_of<group_norm<2>, shape{3, 4, 6}>() == texts{"layer.weight 6", "layer.bias 6"});
    CHECK(arrays[0].role == parameter_role::scale);
    CHECK(arrays[1].role == parameter_role::shift);
}

TEST_CASE("layer_norm: a whole frame, with a weight for each element") {
    check_layer<layer_norm<norm_over::frame>, shape{3, 4, 2}>();
}
TEST_CASE("layer_norm: the channels of each pixel") {
    check_layer<layer_norm<norm_over::channels>, shape{3, 4, 7}>();
    check_layer<layer_norm<norm_over::channels>, shape{1, 1, 3}>();
}
TEST_CASE("layer_norm: a mean of ten thousand, a deviation of a hundredth") {
    check_layer<layer_norm<norm_over::frame>, shape{4, 3, 2}>({.low = 1e4 - 2e-2, .high = 1e4 + 2e-2});
    check_layer<layer_norm<norm_over::channels>, shape{2, 2, 6}>({.low = 1e4 - 2e-2, .high = 1e4 + 2e-2});
}
TEST_CASE("layer_norm: within lists") {
    check_layer<
        sequence<conv2d<4, 3>, layer_norm<norm_over::channels>, relu, layer_norm<norm_over::frame>, dense<3>>,
        shape{4, 3, 2}>();
}

TEST_CASE("layer_norm: arrays have PyTorch's extents") {
    CHECK(arrays_of<layer_norm<norm_over::frame>, shape{3, 4, 6}>() ==
          texts{"layer.weight 6x3x4", "layer.bias 6x3x4"});
    CHECK(arrays_of<layer_norm<norm_over::channels>, shape{3, 4, 6}>() ==
          texts{"layer.weight 6", "layer.bias 6"});
}

// Large α, so that the norm does something to numbers around one.
TEST_CASE("local_response_norm: what must hold of every layer") {
    // AlexNet's exponent, windows cut at both ends.
    check_layer<local_response_norm<5, std::ratio<2>>, shape{2, 3, 9}>();
    // An even size, the square root.
    check_layer<local_response_norm<4, std::ratio<1>, std::ratio<1, 2>, std::ratio<2>>, shape{2, 2, 6}>();
    // More than there are channels, exponent one.
    check_layer<local_response_norm<7, std::ratio<1, 2>, std::ratio<1>>, shape{2, 2, 3}>();
    // Any exponent, one channel.
    check_layer<local_response_norm<1, std::ratio<1>, std::ratio<4, 5>>, shape{2, 2, 4}>();
    check_layer<local_response_norm<>, shape{2, 3, 7}>({.low = -90, .high = 90}); // constants as in Caffe
}
