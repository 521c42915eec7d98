#include <tactnet/networks/imagenet/resnet.hpp>

#include <doctest/doctest.h>

#include <networks/imagenet/stages.hpp>

using namespace tactnet;

TEST_CASE("resnet: 18 layers, every block as torchvision") {
    support::golden_stages golden("resnet18");
    support::compare_stages<resnet18<shape{64, 64, 3}, 10>>(golden, "fc");
    MESSAGE("largest error ÷ its deviation: " << golden.worst);
    CHECK(golden.compared == 3 + 8 + 2 + 1);
}
