#include <tactnet/networks/imagenet.hpp>

#include <doctest/doctest.h>

#include <networks/imagenet/stages.hpp>
#include <networks/learns.hpp>

using namespace tactnet;

// The paper's table 1 has 1.25 million parameters for version 1.0; torchvision's model cards the rest.
static_assert(squeezenet1_0<shape{224, 224, 3}>::parameters == 1248424);
static_assert(squeezenet1_1<shape{224, 224, 3}>::parameters == 1235496);
static_assert(squeezenet1_1_trunk<shape{227, 227, 3}>::parameters == 722496);
static_assert(squeezenet1_1_trunk<shape{227, 227, 3}>::output_shape == shape{14, 14, 512});
static_assert(squeezenet1_0_trunk<shape{224, 224, 3}>::output_shape == shape{13, 13, 512});
static_assert(squeezenet1_1<shape{224, 224, 3}>::multiply_adds == 349151936);

TEST_CASE("squeezenet: version 1.1, every stage as torchvision") {
    support::golden_stages golden("squeezenet1_1");
    CHECK(golden.has_names_of<squeezenet1_1<shape{224, 224, 3}>>());
    support::compare_stages<squeezenet1_1<shape{67, 67, 3}, 10>>(golden, "classifier.3");
    MESSAGE("largest error ÷ its deviation: " << golden.worst);
    CHECK(golden.compared == 13 + 4 + 1);
}

TEST_CASE("squeezenet: version 1.0, every stage as torchvision") {
    support::golden_stages golden("squeezenet1_0");
    CHECK(golden.has_names_of<squeezenet1_0<shape{224, 224, 3}>>());
    support::compare_stages<squeezenet1_0<shape{67, 67, 3}, 10>>(golden, "classifier.3");
    MESSAGE("largest error ÷ its deviation: " << golden.worst);
    CHECK(golden.compared == 13 + 4 + 1);
}

// Without the classifier's dropout, whose chance a few steps on a dozen samples do not even out.
TEST_CASE("squeezenet: fire modules learn, and so does the convolution after them") {
    support::check_learns<
        network<shape{9, 11, 3},
                named<"features", sequential<conv2d<6, 3, 2, padding::valid>, relu, squeezenet_fire<4, 6>>>,
                conv2d<5, 1>, global_average_pool>>();
}
