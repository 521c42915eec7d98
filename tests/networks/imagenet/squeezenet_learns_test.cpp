#include <tactnet/networks/imagenet/squeezenet.hpp>

#include <networks/learns.hpp>

using namespace tactnet;

// Without the classifier's dropout, whose chance a few steps on a dozen samples do not even out.
TEST_CASE("squeezenet: fire modules learn, and so does the convolution after them") {
    support::check_learns<network<
        shape{9, 11, 3}, named<"features", sequential<conv2d<6, 3, 2, padding::valid>, relu, fire<4, 6>>>,
        conv2d<5, 1>, global_average_pool>>();
}
