#include "deployed_network.hpp"

#include <tactnet/networks/imagenet.hpp>
#include <tactnet/runtime/thread_pool.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <networks/imagenet/stages.hpp>
#include <span>
#include <support/same_bits.hpp>
#include <vector>

// Networks for ImageNet, small in rows and columns, and two whose maps are too large for a stack.

using namespace tactnet;

// Where a convolution is computed by tiles of 2 × 2 outputs, the terms that go through it are larger: for 3 ×
// 3 taps of like size (8 ÷ 3)² times those of the taps, while channels + 11 roundings take the place of 9
// channels + 3. So deviations are at most (8 ÷ 3)² × √(11 + 1) ÷ √12 ≈ 7 times as large (one channel),
// and 2.4 times with many.
TEST_CASE("deployed: squeezenet gives torchvision's logits") {
    using net_type = squeezenet1_1<shape{67, 67, 3}, 10>;
    net_type net;
    support::fill_by_name(net);
    const auto fast = deploy(net);
    std::vector<float> image(net_type::input_shape.size()), logits(net_type::outputs);
    support::draw_by_name("input", image);
    const auto memory = std::make_unique<deployed<net_type>::workspace>();
    CHECK(fast.infer(tensor_view<const float, net_type::input_shape>(image.data()),
                     std::span<float, net_type::outputs>(logits), *memory) == frame_status::ok);
    support::golden_stages golden("squeezenet1_1");
    golden.compare(
        "classifier.3", logits.size(), [&](std::size_t e) { return logits[e]; }, 2.4);
    MESSAGE("largest error ÷ its deviation: " << golden.worst);
    CHECK(golden.compared == 1);
}

TEST_CASE("deployed: resnet's blocks, every logit lies within the bound of its error") {
    using blocks = unnamed<resnet_stem,                                                                     //
                           named<"layer1", sequential<basic_block<64, 1, false>, bottleneck<16, 2, true>>>, //
                           named<"layer2", sequential<bottleneck<16, 1, false>>>>;
    CHECK(support::errors_of<resnet<shape{18, 20, 3}, blocks, 10>>(52, 1));
}

// All threads share each step of the first network; each takes frames of its own through the second, whose
// steps are small whatever the vectors, in memory of its own.
using shared_steps = network<shape{200, 200, 1}, conv2d<16, 1>, relu, global_average_pool>;
using small_steps = network<shape{600, 600, 1}, max_pool<8>, conv2d<3, 3>, relu, global_average_pool>;
static_assert(deployed<shared_steps>::view_type::layerwise && !deployed<small_steps>::view_type::layerwise);

TEST_CASE_TEMPLATE("deployed: maps too large for a stack lie on the heap, one by one and on threads", net,
                   shared_steps, small_steps) {
    constexpr std::size_t frames = 3;
    net trained;
    support::fill(trained, 53);
    const auto fast = deploy(trained);
    using fast_net = deployed<net>;
    static_assert(fast_net::workspace_bytes > fast_net::view_type::max_stack_bytes);
    const std::vector<std::uint8_t> counts = support::make_frame(frames * net::input_shape.size(), 54);
    const auto memory = std::make_unique<typename fast_net::workspace>();
    std::vector<float> together(frames * net::outputs), alone(net::outputs);
    thread_pool threads(2);
    CHECK(fast.infer(std::span<const std::uint8_t>(counts), std::span<float>(together), threads) ==
          frame_status::ok);
    for (std::size_t i = 0; i < frames; ++i) {
        CHECK(fast.infer(tensor_view<const std::uint8_t, net::input_shape>(counts.data() +
                                                                           i * net::input_shape.size()),
                         std::span<float, net::outputs>(alone), *memory) == frame_status::ok);
        CHECK(support::same_bits(alone, std::span(together).subspan(i * net::outputs, net::outputs)));
    }
}
