#include <tactnet/simulation/effects/mechanics/tactel_average.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>

namespace {

using namespace tactnet::simulation;

constexpr tactnet::shape cells{4, 6};

TEST_CASE("tactel_average: each tactel is the mean of its own square of cells") {
    tactnet::tensor<float, cells> from;
    for (std::size_t row = 0; row < cells.rows; ++row)
        for (std::size_t column = 0; column < cells.columns; ++column)
            from(row, column) = static_cast<float>(10 * row + column);
    using bound = tactel_average<2>::bound<cells>;
    static_assert(bound::tactels == tactnet::shape{2, 3});
    tactnet::tensor<float, bound::tactels> means;
    bound({}, {}).apply(from, means.view(), {});
    for (std::size_t row = 0; row < 2; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            CHECK(means(row, column) == static_cast<float>(20 * row + 2 * column) + 5.5f);
}

TEST_CASE("tactel_average: one cell a tactel changes no bit") {
    tactnet::tensor<float, cells> from, means;
    for (std::size_t i = 0; i < cells.size(); ++i)
        from.data()[i] = static_cast<float>(i) * 0.37f;
    tactel_average<1>::bound<cells>({}, {}).apply(from, means.view(), {});
    CHECK(std::ranges::equal(from, means));
}

} // namespace
