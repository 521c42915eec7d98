#include <tactnet/layers/composition/norm_relu_pool.hpp>

#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

// Windows that meet every pixel once, that overlap, that leave pixels out and that reach over the edge; no
// pooling at all.

TEST_CASE("norm_relu_pool: 2, stride 2, even sizes") {
    check_layer<norm_relu_pool<2>, shape{4, 6, 3}>();
}
TEST_CASE("norm_relu_pool: 2, stride 2, odd sizes keep the rest") {
    check_layer<norm_relu_pool<2>, shape{7, 5, 2}>();
}
TEST_CASE("norm_relu_pool: 2, stride 2, valid drops the rest") {
    check_layer<norm_relu_pool<2, 2, padding::valid>, shape{7, 5, 2}>();
}
TEST_CASE("norm_relu_pool: 2, stride 1") {
    check_layer<norm_relu_pool<2, 1>, shape{5, 4, 3}>();
}
TEST_CASE("norm_relu_pool: 3, stride 2, padding given") {
    check_layer<norm_relu_pool<3, 2, pad(1)>, shape{5, 6, 1}>();
}
TEST_CASE("norm_relu_pool: 1, stride 2 looks at every other pixel") {
    check_layer<norm_relu_pool<1, 2>, shape{5, 4, 2}>();
}
TEST_CASE("norm_relu_pool: 4 × 4, larger than what is unrolled") {
    check_layer<norm_relu_pool<4, 3>, shape{7, 6, 1}>();
}
TEST_CASE("norm_relu_pool: without a pool") {
    check_layer<norm_relu_pool<1>, shape{5, 4, 3}>();
}
TEST_CASE("norm_relu_pool: large values with a small deviation") {
    check_layer<norm_relu_pool<2>, shape{4, 4, 2}>({.low = 1e3 - 2e-2, .high = 1e3 + 2e-2});
}
