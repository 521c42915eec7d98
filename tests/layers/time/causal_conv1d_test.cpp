#include <tactnet/layers.hpp>

#include <support/layers/conformance.hpp>
#include <support/layers/reference_of_time.hpp>

using namespace tactnet;

TEST_CASE("causal_conv1d: what must hold of every layer") {
    support::check_layer<causal_conv1d<5, 3>, shape{7, 1, 3}>();
    support::check_layer<causal_conv1d<4, 2, 3>, shape{9, 1, 5}>();
    support::check_layer<causal_conv1d<1, 1>, shape{1, 1, 1}>();
    // Taps that lie before the first frame for every output.
    support::check_layer<causal_conv1d<17, 4, 2>, shape{3, 1, 2}>();
    support::check_layer<
        sequence<causal_conv1d<6, 3>, relu, residual<causal_conv1d<6, 3, 2>>, last_frame, dense<3>>,
        shape{8, 1, 2}>();
}
TEST_CASE("causal_conv1d: names and extents are those of PyTorch's Conv1d") {
    using bound = sequence<causal_conv1d<5, 3>>::layer<float, shape{7, 1, 2}>;
    std::vector<parameter> list;
    bound::describe("", list);
    REQUIRE(list.size() == 2);
    CHECK(list[0].name == "conv1.weight");
    CHECK(list[0].extents == std::vector<std::size_t>{5, 2, 3});
    CHECK(list[1].name == "conv1.bias");
}
TEST_CASE("last_frame: what must hold of every layer") {
    support::check_layer<last_frame, shape{4, 1, 3}>();
    support::check_layer<last_frame, shape{1, 1, 1}>();
}
