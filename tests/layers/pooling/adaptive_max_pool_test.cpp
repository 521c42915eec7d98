#include <tactnet/layers/pooling/adaptive_max_pool.hpp>

#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

TEST_CASE("adaptive_max_pool: bins overlap where they must, and repeat where there is too little") {
    check_layer<adaptive_max_pool<extent2d{3, 4}>, shape{5, 9, 2}>();
    check_layer<adaptive_max_pool<7>, shape{3, 10, 1}>();
}
TEST_CASE("adaptive_max_pool: bins side by side, of one pixel and of the whole image") {
    check_layer<adaptive_max_pool<extent2d{2, 3}>, shape{6, 9, 3}>();
    check_layer<adaptive_max_pool<extent2d{4, 5}>, shape{4, 5, 2}>();
    check_layer<adaptive_max_pool<1>, shape{5, 3, 2}>();
}
TEST_CASE("adaptive_max_pool: in a list, after a layer that writes over its input") {
    check_layer<sequence<conv2d<5, 3>, relu, adaptive_max_pool<extent2d{3, 2}>, dense<4>>, shape{7, 5, 2}>();
}
TEST_CASE("adaptive_max_pool: of equal largest values the first gets the gradient, as in PyTorch") {
    using bound = adaptive_max_pool<2>::layer<float, shape{2, 3, 1}>; // columns 0, 1 and 1, 2
    batch<float, shape{2, 3, 1}, kernels::lanes<float>> in(1), in_gradient(1);
    batch<float, shape{2, 2, 1}, kernels::lanes<float>> out(1), out_gradient(1);
    const float rows[] = {1, 1, 1, 2, 5, 5};
    for (std::size_t i = 0; i < 6; ++i)
        in(0, i) = rows[i];
    for (std::size_t i = 0; i < 4; ++i)
        out_gradient(0, i) = static_cast<float>(i + 1);
    bound::forward_block(in.view().lane_block(0), out.view().lane_block(0));
    bound::backward_block(in.view().lane_block(0), out.view().lane_block(0),
                          out_gradient.view().lane_block(0), in_gradient.view().lane_block(0));
    const float expected[] = {1, 2, 0, 0, 3 + 4, 0};
    for (std::size_t i = 0; i < 6; ++i)
        CHECK(in_gradient(0, i) == expected[i]);
}
