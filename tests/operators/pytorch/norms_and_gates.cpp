// Norms and gates compared with PyTorch's own: weight files that write_models.py has made, with PyTorch's
// names, whose self-test loading repeats; and the same deployed.

#include <tactnet/deployment.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

using namespace tactnet;

namespace {

/// Loads a file, which compares the trained network with PyTorch, and compares the deployed one by the same
/// tolerance.
template <class Network>
void compare(const char* name) {
    const char* const folder = std::getenv("TACTNET_PYTORCH_MODELS");
    REQUIRE_MESSAGE(folder != nullptr, "set TACTNET_PYTORCH_MODELS to the folder that write_models.py wrote");
    const safetensors file =
        safetensors::read(std::filesystem::path(folder) / (std::string(name) + ".safetensors"));
    const std::vector<float> expected = file.values<float>("selftest.logits");
    const std::vector<std::uint8_t> images = file.values<std::uint8_t>("selftest.input");
    const auto fast = deploy(load_model<Network>(file));
    float largest = 0;
    for (const float value : expected)
        largest = std::max(largest, std::abs(value));
    std::vector<float> found(Network::outputs);
    for (std::size_t image = 0; image < images.size() / Network::input_shape.size(); ++image) {
        CAPTURE(image);
        REQUIRE(fast.infer(tensor_view<const std::uint8_t, Network::input_shape>(
                               images.data() + image * Network::input_shape.size()),
                           std::span<float, Network::outputs>(found)) == frame_status::ok);
        std::size_t outside = 0;
        for (std::size_t o = 0; o < found.size(); ++o)
            outside += !(std::abs(found[o] - expected[image * found.size() + o]) <=
                         detail::selftest_tolerance * largest);
        CHECK(outside == 0);
    }
}

constexpr shape image{9, 11, 3};

} // namespace

TEST_CASE("PyTorch: squeeze and excitation, by itself and as in MobileNetV3") {
    compare<network<image, named<"se", squeeze_excitation<3, 2>>>>("squeeze_excitation");
    compare<network<image, conv2d<12, 3>, hard_swish, named<"se", squeeze_excitation<12, 5, hard_sigmoid>>,
                    conv2d<4, 1>>>("mobile");
}

TEST_CASE("PyTorch: a block of ConvNeXt, with layer norm, GELU and layer scale") {
    using block =
        residual<sequence<named<"dwconv", conv2d<8, 7, 1, padding::same, in_groups(8)>>,
                          named<"norm", layer_norm<norm_over::channels>>, named<"pwconv1", conv2d<24, 1>>,
                          gelu, named<"pwconv2", conv2d<8, 1>>, named<"ls", channel_scale>>>;
    compare<network<image, conv2d<8, 3>, block>>("convnext");
}

TEST_CASE("PyTorch: GroupNorm, InstanceNorm2d, LayerNorm of frames and of channels") {
    compare<network<image, conv2d<20, 3>, group_norm<5>>>("group_norm");
    compare<network<image, instance_norm>>("instance_norm");
    compare<network<image, layer_norm<norm_over::frame>>>("layer_norm_frame");
    compare<network<image, conv2d<7, 3>, layer_norm<norm_over::channels>>>("layer_norm_channels");
}
