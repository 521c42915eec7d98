#include <tactnet/layers.hpp>

#include <support/layers/conformance.hpp>
#include <support/layers/reference_of_time.hpp>

using namespace tactnet;

TEST_CASE("gru: what must hold of every layer") {
    support::check_layer<gru<5>, shape{7, 1, 3}>();
    support::check_layer<gru<1>, shape{1, 1, 1}>();
    support::check_layer<gru<19>, shape{3, 1, 17}>();
    support::check_layer<sequence<gru<6>, gru<4>, last_frame, dense<3>>, shape{5, 1, 4}>();
}
TEST_CASE("gru: names and extents are PyTorch's") {
    using bound = sequence<gru<5>, last_frame, dense<2>>::layer<float, shape{7, 1, 3}>;
    std::vector<parameter> list;
    bound::describe("", list);
    REQUIRE(list.size() == 6);
    CHECK(list[0].name == "gru.weight_ih_l0");
    CHECK(list[0].extents == std::vector<std::size_t>{15, 3});
    CHECK(list[1].name == "gru.weight_hh_l0");
    CHECK(list[1].extents == std::vector<std::size_t>{15, 5});
    CHECK(list[2].name == "gru.bias_ih_l0");
    CHECK(list[3].name == "gru.bias_hh_l0");
    CHECK(list[3].extents == std::vector<std::size_t>{15});
    CHECK(list[4].name == "fc.weight");
}
