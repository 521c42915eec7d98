#include <tactnet/networks/imagenet/resnet.hpp>

#include <networks/learns.hpp>

using namespace tactnet;

TEST_CASE("resnet: blocks with and without a projection learn") {
    using blocks = unnamed<named<"conv1", resnet_convolution<8, 3, 2>>, named<"bn1", batch_norm>, relu,
                           named<"layer1", sequential<basic_block<8, 1, false>, bottleneck<4, 2, true>>>>;
    support::check_learns<resnet<shape{9, 11, 3}, blocks, 5>>();
}
