#include <tactnet/networks/squeezenet.hpp>

#include <networks/learns.hpp>

using namespace tactnet;

TEST_CASE("squeezenet: fire modules learn, as the whole network does in small") {
    support::check_learns<
        network<shape{9, 11, 3}, named<"features", sequential<conv2d<6, 3, 2, valid>, relu, fire<4, 6>>>,
                squeezenet_classifier<5>>>();
}
