#include <tactnet/layers/pooling/average_pool.hpp>

#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

TEST_CASE("average_pool: 2, stride 2, odd sizes: the rest is divided by its own pixels") {
    check_layer<average_pool<2>, shape{5, 7, 3}>();
}
TEST_CASE("average_pool: 3, stride 1 × 2, padding counted and not") {
    check_layer<average_pool<3, extent2d{1, 2}, pad(1), average_over::pixels_and_padding>, shape{4, 7, 2}>();
    check_layer<average_pool<3, extent2d{1, 2}, pad(1)>, shape{4, 7, 2}>();
}
TEST_CASE("average_pool: ceil mode counts the padding that was given, not what completes a window") {
    check_layer<average_pool<3, 2, ceil_mode(pad(1)), average_over::pixels_and_padding>, shape{6, 8, 2}>();
    check_layer<average_pool<3, 2, ceil_mode()>, shape{6, 7, 1}>();
}
TEST_CASE("average_pool: a window of the whole image") {
    check_layer<average_pool<extent2d{4, 3}, 1, padding::valid>, shape{4, 3, 2}>();
}
TEST_CASE("adaptive_average_pool: bins overlap where they must, and repeat where there is too little") {
    check_layer<adaptive_average_pool<extent2d{3, 4}>, shape{5, 9, 2}>();
    check_layer<adaptive_average_pool<7>, shape{3, 10, 1}>();
}
TEST_CASE("global_average_pool: the mean of each channel") {
    check_layer<global_average_pool, shape{5, 6, 3}>();
}

// PyTorch: AdaptiveAvgPool2d(4) of 10 gives the bins 0-3, 2-5, 5-8, 7-10.
constexpr average_axis bins{.size = 10, .outputs = 4};
static_assert(bins.pixels(0).end == 3 && bins.pixels(1).begin == 2 && bins.pixels(1).end == 5 &&
              bins.pixels(2).begin == 5 && bins.pixels(2).end == 8 && bins.pixels(3).begin == 7);
