#include <tactnet/layers/dense.hpp>

#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

TEST_CASE("dense: one output") {
    check_layer<dense<1>, shape{5, 4, 3}>();
}
TEST_CASE("dense: 22 outputs") {
    check_layer<dense<22>, shape{4, 7, 5}>();
}
TEST_CASE("dense: one input") {
    check_layer<dense<3>, shape{1, 1, 1}>();
}
TEST_CASE("dense: more outputs than inputs") {
    check_layer<dense<22>, shape{1, 3, 2}>();
}
