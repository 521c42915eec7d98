#include <tactnet/svm/feature_rows.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <stdexcept>
#include <vector>

using namespace tactnet;

TEST_CASE("feature_rows: whole rows only, of the number of features that the type says") {
    const std::vector<float> values(12);
    CHECK(feature_rows<4>(values).size() == 3);
    CHECK(feature_rows<>(values, 6).size() == 2);
    CHECK_THROWS_AS((feature_rows<5>{values}), std::invalid_argument);
    CHECK_THROWS_AS((feature_rows<4>{values, 6}), std::invalid_argument);
    CHECK_THROWS_AS((feature_rows<>{values, 0}), std::invalid_argument);
}

TEST_CASE("for_each_block: every row once and in order, in blocks of no more bytes than there may be") {
    for (const std::size_t rows : {0u, 1u, 2u, 63u, 1000u})
        for (const std::size_t bytes : {std::size_t{0}, std::size_t{1}, std::size_t{1} << 20U,
                                        (std::size_t{1} << 24U) - 1, std::size_t{1} << 40U}) {
            std::vector<float> values(rows * 3);
            const float* next = values.data();
            detail::for_each_block(feature_rows<3>(values), bytes, [&](feature_rows<3> block) {
                CHECK(block.values().data() == next);
                CHECK(block.size() > 0);
                CHECK((block.size() == 1 || block.size() * bytes <= std::size_t{1} << 24U));
                next += block.values().size();
            });
            CHECK(next == values.data() + values.size());
        }
}
