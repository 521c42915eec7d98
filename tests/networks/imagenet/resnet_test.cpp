#include <tactnet/networks/imagenet.hpp>

#include <doctest/doctest.h>

#include <networks/imagenet/stages.hpp>
#include <networks/learns.hpp>

using namespace tactnet;

static_assert(resnet18<shape{224, 224, 3}>::parameters == 11689512);
static_assert(resnet34<shape{224, 224, 3}>::parameters == 21797672);
static_assert(resnet50<shape{224, 224, 3}>::parameters == 25557032);
static_assert(resnet50<shape{224, 224, 3}>::multiply_adds == 4089184256);

TEST_CASE("resnet: names of 18, 34 and 50 layers as torchvision's") {
    CHECK(support::golden_stages("resnet18").has_names_of<resnet18<shape{224, 224, 3}>>());
    CHECK(support::golden_stages("resnet34").has_names_of<resnet34<shape{224, 224, 3}>>());
    CHECK(support::golden_stages("resnet50").has_names_of<resnet50<shape{224, 224, 3}>>());
}

TEST_CASE("resnet: 50 layers, every block as torchvision") {
    support::golden_stages golden("resnet50");
    support::compare_stages<resnet50<shape{64, 64, 3}, 10>>(golden, "fc");
    MESSAGE("largest error ÷ its deviation: " << golden.worst);
    CHECK(golden.compared == 3 + 16 + 2 + 1);
}

TEST_CASE("resnet: 18 layers, every block as torchvision") {
    support::golden_stages golden("resnet18");
    support::compare_stages<resnet18<shape{64, 64, 3}, 10>>(golden, "fc");
    MESSAGE("largest error ÷ its deviation: " << golden.worst);
    CHECK(golden.compared == 3 + 8 + 2 + 1);
}

TEST_CASE("resnet: blocks with and without a projection learn") {
    using blocks = unnamed<named<"conv1", resnet_convolution<8, 3, 2>>, named<"bn1", batch_norm>, relu,
                           named<"layer1", sequential<basic_block<8, 1, false>, bottleneck<4, 2, true>>>>;
    support::check_learns<resnet<shape{9, 11, 3}, blocks, 5>>();
}
