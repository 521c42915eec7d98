#include <tactnet/eigen/elements.hpp>
#include <tactnet/layers/dense.hpp>
#include <tactnet/networks/network.hpp>

#include <doctest/doctest.h>

#include <array>
#include <stdexcept>
#include <vector>

using namespace tactnet;

TEST_CASE("elements: vectors are spans of fixed or of dynamic extent") {
    Eigen::Vector<float, 22> logits;
    const auto view = view_elements(logits);
    static_assert(std::is_same_v<decltype(view), const std::span<float, 22>>);
    static_assert(noexcept(view_elements(logits)));
    CHECK(view.data() == logits.data());
    const Eigen::RowVectorXf dynamic = Eigen::RowVectorXf::Zero(22);
    static_assert(std::is_same_v<decltype(view_elements(dynamic)), std::span<const float>>);
    CHECK(view_elements(dynamic).data() == dynamic.data());
    CHECK(view_elements(dynamic).size() == 22);
    const std::span<const float, 22> asked = view_elements<22>(dynamic);
    CHECK(asked.data() == dynamic.data());
    static_assert(noexcept(try_view_elements<22>(dynamic)));
    CHECK_FALSE(try_view_elements<21>(dynamic));
    CHECK_THROWS_WITH_AS((void)view_elements<21>(dynamic),
                         "elements: expected 21 coefficients without gaps, found 22", std::invalid_argument);
}

TEST_CASE("elements: a matrix with a row for each frame is one run of numbers") {
    Eigen::Matrix<float, Eigen::Dynamic, 5, Eigen::RowMajor> rows(3, 5);
    CHECK(view_elements(rows).data() == rows.data());
    CHECK(view_elements(rows).size() == 15);
    CHECK(view_elements<5>(rows.row(1)).data() == &rows(1, 0));
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> wide(3, 8);
    CHECK_THROWS_WITH_AS((void)view_elements(wide.leftCols(5)),
                         "elements: expected coefficients without gaps, found 15 with gaps between them",
                         std::invalid_argument);
    Eigen::Matrix<float, Eigen::Dynamic, 5, Eigen::RowMajor> none(0, 5);
    CHECK(view_elements(none).empty());
}

TEST_CASE("elements: spans, arrays and vectors become Eigen's vectors in place") {
    std::array<float, 4> logits{1, 2, 3, 4};
    auto fixed = map_vector(logits);
    static_assert(std::is_same_v<decltype(fixed), Eigen::Map<Eigen::Vector4f>>);
    fixed *= 2;
    CHECK(logits[3] == 8);
    const std::vector<double> numbers{1, 2, 3};
    const auto dynamic = map_vector(numbers);
    static_assert(std::is_same_v<decltype(dynamic), const Eigen::Map<const Eigen::VectorXd>>);
    CHECK(dynamic.data() == numbers.data());
    CHECK(dynamic.sum() == 6);
    CHECK(map_vector(std::span<float, 4>(logits)).data() == logits.data());
    // And back.
    const auto back = view_elements(map_vector(logits));
    static_assert(std::is_same_v<decltype(back), const std::span<float, 4>>);
    CHECK(back.data() == logits.data());
}

TEST_CASE("elements: rows of logits become a matrix in place") {
    std::vector<float> logits(6);
    auto rows = map_rows<3>(logits);
    static_assert(decltype(rows)::ColsAtCompileTime == 3 && decltype(rows)::IsRowMajor);
    CHECK(rows.rows() == 2);
    rows(1, 0) = 5;
    CHECK(logits[3] == 5);
    CHECK(map_rows<1>(logits).rows() == 6);
    CHECK(map_rows<3>(std::span<float>()).rows() == 0);
    CHECK_THROWS_WITH_AS((void)map_rows<4>(logits), "rows: expected whole rows of 4 numbers, found 6 numbers",
                         std::invalid_argument);
}

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
