#include <tactnet/layers.hpp>

#include <support/layers/conformance.hpp>
#include <support/layers/reference_of_time.hpp>

using namespace tactnet;

TEST_CASE("lstm: what must hold of every layer") {
    support::check_layer<lstm<5>, shape{7, 1, 3}>();
    support::check_layer<lstm<1>, shape{1, 1, 1}>();
    support::check_layer<lstm<18>, shape{3, 1, 19}>();
    support::check_layer<sequence<lstm<4>, relu, lstm<3>, last_frame>, shape{4, 1, 2}>();
}
TEST_CASE("lstm: names and extents are PyTorch's") {
    using bound = sequence<lstm<5>, lstm<2>>::layer<float, shape{7, 1, 3}>;
    std::vector<parameter> list;
    bound::describe("", list);
    REQUIRE(list.size() == 8);
    CHECK(list[0].name == "lstm1.weight_ih_l0");
    CHECK(list[0].extents == std::vector<std::size_t>{20, 3});
    CHECK(list[5].name == "lstm2.weight_hh_l0");
    CHECK(list[5].extents == std::vector<std::size_t>{8, 2});
    CHECK(list[6].extents == std::vector<std::size_t>{8});
}
