#include <tactnet/svm/feature_rows.hpp>

#include <doctest/doctest.h>

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
