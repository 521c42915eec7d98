#include <tactnet/networks/imagenet.hpp>

#include <doctest/doctest.h>

#include <networks/imagenet/stages.hpp>

using namespace tactnet;

static_assert(vgg16<shape{224, 224, 3}>::parameters == 138357544);
static_assert(vgg16<shape{224, 224, 3}>::multiply_adds == 15470264320);

static_assert(vgg16_fc6<shape{224, 224, 3}>::parameters == 138357544 - 4097 * 4096 - 4097 * 1000);
static_assert(vgg16_fc6<shape{224, 224, 3}>::outputs == 4096);

TEST_CASE("vgg16: its features end before the second dense layer and the ReLU before it") {
    CHECK(support::begins_as<vgg16_fc6<shape{224, 224, 3}>, vgg16<shape{224, 224, 3}>>(
        {"classifier.3.weight", "classifier.3.bias", "classifier.6.weight", "classifier.6.bias"}));
}

TEST_CASE("vgg16: every stage as torchvision") {
    support::golden_stages golden("vgg16");
    CHECK(golden.has_names_of<vgg16<shape{224, 224, 3}>>());
    support::compare_stages<vgg16<shape{32, 32, 3}, 10, 48>>(golden, "classifier.6");
    MESSAGE("largest error ÷ its deviation: " << golden.worst);
    CHECK(golden.compared == 31 + 1 + 7 + 1);
}
