#include <tactnet/networks/imagenet/squeezenet.hpp>

#include <doctest/doctest.h>

#include <networks/imagenet/stages.hpp>

using namespace tactnet;

TEST_CASE("squeezenet: version 1.0, every stage as torchvision") {
    support::golden_stages golden("squeezenet1_0");
    CHECK(golden.has_names_of<squeezenet1_0<shape{224, 224, 3}>>());
    support::compare_stages<squeezenet1_0<shape{67, 67, 3}, 10>>(golden, "classifier.3");
    MESSAGE("largest error ÷ its deviation: " << golden.worst);
    CHECK(golden.compared == 13 + 4 + 1);
}
