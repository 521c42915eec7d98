#include <tactnet/layers.hpp>

#include <string>
#include <support/layers/conformance.hpp>
#include <vector>

using namespace tactnet;
using support::check_layer;

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
    const auto arrays = support::make_layer<channel_scale, float, shape{3, 4, 6}>()->describe();
    REQUIRE(arrays.size() == 1);
    CHECK(arrays[0].name == "layer.gamma");
    CHECK(arrays[0].extents == std::vector<std::size_t>{6});
    CHECK(arrays[0].role == parameter_role::scale);
}
