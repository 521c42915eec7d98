#include <tactnet/operators/dense/layer.hpp>

#include <support/layers/conformance.hpp>

using namespace tactnet;
using support::check_layer;

TEST_CASE("dense: what must hold of every layer") {
    check_layer<dense<1>, shape{5, 4, 3}>();  // one output
    check_layer<dense<22>, shape{4, 7, 5}>(); // 22 outputs
    check_layer<dense<3>, shape{1, 1, 1}>();  // one input
    check_layer<dense<22>, shape{1, 3, 2}>(); // more outputs than inputs
}
