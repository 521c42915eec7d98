#include <tactnet/networks/imagenet.hpp>

#include <doctest/doctest.h>

#include <networks/imagenet/stages.hpp>

using namespace tactnet;

static_assert(alexnet<shape{224, 224, 3}>::parameters == 61100840);
static_assert(alexnet<shape{224, 224, 3}>::multiply_adds == 714188480);
static_assert(alexnet_original<shape{227, 227, 3}>::parameters == 60965224);

static_assert(alexnet_fc7<shape{224, 224, 3}>::parameters == 61100840 - 4097 * 1000);
static_assert(alexnet_fc7<shape{224, 224, 3}>::outputs == 4096);

TEST_CASE("alexnet: its features end before the last layer and its ReLU") {
    CHECK(support::begins_as<alexnet_fc7<shape{224, 224, 3}>, alexnet<shape{224, 224, 3}>>(
        {"classifier.6.weight", "classifier.6.bias"}));
}

TEST_CASE("alexnet: every stage as torchvision") {
    support::golden_stages golden("alexnet");
    CHECK(golden.has_names_of<alexnet<shape{224, 224, 3}>>());
    support::compare_stages<alexnet<shape{67, 67, 3}, 10, 48>>(golden, "classifier.6");
    MESSAGE("largest error ÷ its deviation: " << golden.worst);
    CHECK(golden.compared == 13 + 1 + 7 + 1);
}

TEST_CASE("alexnet: the original, every layer with weights as PyTorch") {
    support::golden_stages golden("alexnet_original");
    support::compare_stages<alexnet_original<shape{67, 67, 3}, 10, 48>>(golden, "fc8");
    MESSAGE("largest error ÷ its deviation: " << golden.worst);
    CHECK(golden.compared == 8 + 1);
}
