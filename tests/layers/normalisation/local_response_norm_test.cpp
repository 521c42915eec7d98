#include <tactnet/layers/normalisation/local_response_norm.hpp>

#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

// Large α, so that the norm does something to numbers around one.
TEST_CASE("local_response_norm: AlexNet's exponent, windows cut at both ends") {
    check_layer<local_response_norm<5, std::ratio<2>>, shape{2, 3, 9}>();
}
TEST_CASE("local_response_norm: an even size, the square root") {
    check_layer<local_response_norm<4, std::ratio<1>, std::ratio<1, 2>, std::ratio<2>>, shape{2, 2, 6}>();
}
TEST_CASE("local_response_norm: more than there are channels, exponent one") {
    check_layer<local_response_norm<7, std::ratio<1, 2>, std::ratio<1>>, shape{2, 2, 3}>();
}
TEST_CASE("local_response_norm: any exponent, one channel") {
    check_layer<local_response_norm<1, std::ratio<1>, std::ratio<4, 5>>, shape{2, 2, 4}>();
}
TEST_CASE("local_response_norm: constants as in Caffe") {
    check_layer<local_response_norm<>, shape{2, 3, 7}>({.low = -90, .high = 90});
}
