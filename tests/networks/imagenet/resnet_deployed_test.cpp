#include <tactnet/deployment.hpp>
#include <tactnet/networks/imagenet.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <memory>
#include <networks/imagenet/stages.hpp>
#include <span>
#include <vector>

using namespace tactnet;

TEST_CASE("resnet: 50 layers, deployed, give torchvision's logits") {
    using net = resnet50<shape{64, 64, 3}, 10>;
    const auto network = std::make_unique<net>();
    support::fill_by_name(*network);
    const auto fast = deploy(*network);
    std::vector<float> image(net::input_shape.size()), logits(net::outputs);
    support::draw_by_name("input", image);
    const auto memory = std::make_unique<deployed<net>::workspace>(); // more than a stack should hold
    const auto status = fast.infer(tensor_view<const float, net::input_shape>(image.data()),
                                   std::span<float, net::outputs>(logits), *memory);
    CHECK(status == frame_status::ok);
    support::golden_stages golden("resnet50");
    golden.compare("fc", net::outputs, [&](std::size_t e) { return logits[e]; });
    MESSAGE("largest error ÷ its deviation: " << golden.worst);
    CHECK(golden.compared == 1);
}
