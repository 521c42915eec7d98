// What networks cost at many sizes, computed without their layers, against the layers' own constants.

#include <tactnet/networks.hpp>

#include <doctest/doctest.h>

using namespace tactnet;

namespace {

struct tactnet6_for_22 {
    template <shape Input>
    using at = tactnet6<Input, 22>;
};
struct economical_for_22 {
    template <shape Input>
    using at = tactnet6_economical<Input, 22>;
};
constexpr auto tactnet6_costs = costs_at_sizes<tactnet6_for_22>();

template <class Network>
void check_costs() {
    constexpr network_costs c = costs_of_network<Network>;
    CAPTURE(Network::input_shape.rows);
    CAPTURE(Network::input_shape.columns);
    CHECK(c.parameters == Network::parameters);
    CHECK(c.statistics == Network::statistics);
    CHECK(c.multiply_adds == Network::multiply_adds);
    CHECK(c.multiply_adds_on_pixels == Network::multiply_adds_on_pixels);
    CHECK(c.parameter_bytes == Network::parameter_bytes);
    CHECK(c.activation_bytes == Network::activation_bytes);
}
template <shape Input>
void check_all() {
    check_costs<tactnet4<Input, 22>>();
    check_costs<tactnet6<Input, 22>>();
    check_costs<tactnet6_economical<Input, 22>>();
    check_costs<tactresnet<Input, 22>>();
    CHECK(tactnet6_costs.at(Input) == costs_of_network<tactnet6<Input, 22>>);
}

/// Every kind of layer that no network of the paper has.
using other_layers =
    network<shape{9, 11}, square_root<>, conv2d<6, extent2d{3, 2}, extent2d{2, 1}, pad(1, 0, 2, 1)>,
            local_response_norm<>, group_norm<2>, instance_norm, layer_norm<norm_over::frame>,
            layer_norm<norm_over::channels>, squeeze_excitation<6, 2>, channel_scale,
            concatenation<conv2d<4, 1>, sequence<conv2d<2, 3, 1, padding::same, without_bias>, relu>>,
            conv2d<12, 3, 1, padding::same, in_groups(3)>, average_pool<3, 2, ceil_mode()>,
            residual<sequence<conv2d<12, 3>, relu>>, named<"inner", sequence<dropout<20>>>,
            adaptive_average_pool<2>, dense<7>, softmax>;

} // namespace

TEST_CASE("costs: those of specifications are those of the layers") {
    check_all<shape{28, 50}>();
    check_all<shape{14, 25}>();
    check_all<shape{10, 18}>();
    check_all<shape{7, 13}>();
    check_all<shape{23, 31}>();
    check_costs<squeezenet1_1<shape{227, 227, 3}, 1000>>();
    check_costs<resnet50<shape{224, 224, 3}, 1000>>();
    check_costs<other_layers>();
    check_costs<other_layers::with_value_type<double>>();
}

TEST_CASE("costs: a table holds every size of the range once") {
    using table = decltype(tactnet6_costs);
    static_assert(table::size == 836);
    static_assert(tactnet6_costs.at({28, 50}).parameters == 104518); // table I of the paper
    static_assert(tactnet6_costs.at({7, 13}).parameters == tactnet6<shape{7, 13}, 22>::parameters);
    std::size_t sizes = 0;
    for (std::size_t rows = 7; rows <= 28; ++rows)
        for (std::size_t columns = 13; columns <= 50; ++columns, ++sizes) {
            CHECK(table::size_of(sizes) == shape{rows, columns});
            CHECK(&tactnet6_costs.at({rows, columns}) == &tactnet6_costs.costs[sizes]);
        }
    CHECK(sizes == table::size);
}

TEST_CASE("costs: fewer tactels never cost the economical form more") {
    constexpr auto costs = costs_at_sizes<economical_for_22, shape{12, 20}, shape{16, 28}>();
    for (std::size_t rows = 12; rows < 16; ++rows)
        for (std::size_t columns = 20; columns < 28; ++columns) {
            const std::size_t here = costs.at({rows, columns}).multiply_adds_on_pixels;
            CHECK(here <= costs.at({rows + 1, columns}).multiply_adds_on_pixels);
            CHECK(here <= costs.at({rows, columns + 1}).multiply_adds_on_pixels);
        }
}
