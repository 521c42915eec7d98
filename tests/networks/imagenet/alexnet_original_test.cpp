#include <tactnet/networks/imagenet/alexnet.hpp>

#include <doctest/doctest.h>

#include <networks/imagenet/stages.hpp>

using namespace tactnet;

TEST_CASE("alexnet: the original, every layer with weights as PyTorch") {
    support::golden_stages golden("alexnet_original");
    support::compare_stages<alexnet_original<shape{67, 67, 3}, 10, 48>>(golden, "fc8");
    MESSAGE("largest error ÷ its deviation: " << golden.worst);
    CHECK(golden.compared == 8 + 1);
}
