#include <tactnet/layers/normalisation/layer_norm.hpp>

#include <string>
#include <support/layers/conformance.hpp>
#include <vector>

using namespace tactnet;
using support::check_layer;

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
    const auto of_frame =
        support::make_layer<layer_norm<norm_over::frame>, float, shape{3, 4, 6}>()->describe();
    CHECK(of_frame[0].extents == std::vector<std::size_t>{6, 3, 4});
    CHECK(of_frame[1].extents == std::vector<std::size_t>{6, 3, 4});
    const auto of_channels =
        support::make_layer<layer_norm<norm_over::channels>, float, shape{3, 4, 6}>()->describe();
    CHECK(of_channels[0].extents == std::vector<std::size_t>{6});
}
