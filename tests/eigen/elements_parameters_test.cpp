#include <tactnet/eigen/elements.hpp>
#include <tactnet/layers/dense.hpp>
#include <tactnet/networks/network.hpp>

#include <doctest/doctest.h>

#include <stdexcept>
#include <vector>

using namespace tactnet;

TEST_CASE("map_parameter: the weights of a dense layer are outputs x inputs, where they lie") {
    network<shape{2, 3}, dense<4>> net;
    int seen = 0;
    net.for_each_parameter([&](const parameter& p, auto values) {
        auto matrix = map_parameter(p.extents, values);
        CHECK(matrix.data() == values.data());
        CHECK(matrix.rows() == 4);
        CHECK(matrix.cols() == (p.name == "fc.weight" ? 6 : 1));
        matrix.row(1).setConstant(3);
        ++seen;
    });
    CHECK(seen == 2);
    const auto& constant = net;
    constant.for_each_parameter([&](const parameter& p, auto values) {
        const auto matrix = map_parameter(p.extents, values);
        CHECK(matrix.sum() == (p.name == "fc.weight" ? 18 : 3));
    });
    CHECK(net.learnable_values()[6] == 3);
    CHECK(net.learnable_values()[12] == 0);
}

TEST_CASE("map_parameter: all extents but the first lie side by side, and must fit the values") {
    std::vector<float> values(24);
    const std::vector<std::size_t> filters{2, 3, 2, 2};
    const auto matrix = map_parameter(filters, std::span(values));
    CHECK(matrix.rows() == 2);
    CHECK(matrix.cols() == 12);
    CHECK_THROWS_WITH_AS((void)map_parameter(filters, std::span(values).first(23)),
                         "map_parameter: expected 2 x 12 values, found 23", std::invalid_argument);
    CHECK(map_parameter({}, std::span(values).first(1)).size() == 1);
}
