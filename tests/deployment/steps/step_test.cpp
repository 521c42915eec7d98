#include <tactnet/deployment/steps/step.hpp>

#include <doctest/doctest.h>

#include <array>
#include <vector>

using namespace tactnet;

TEST_CASE("largest_sum: the largest of |bias| + input x the sum of |weights|, over all outputs") {
    // Two outputs of three weights, then their biases.
    const std::array<float, 8> numbers{1, -2, 3, 4, 5, -6, 7, -8};
    CHECK(detail::largest_sum(numbers.data(), 2, 3, 2) == 2 * 15 + 8);
    CHECK(detail::largest_sum(numbers.data(), 2, 3, 0) == 8);
    const std::array<float, 8> first_is_larger{4, 5, -6, 1, -2, 3, 7, -8};
    CHECK(detail::largest_sum(first_is_larger.data(), 2, 3, 2) == 2 * 15 + 7);
    CHECK(detail::largest_sum(numbers.data(), 0, 3, 2) == 0);
    // In double precision: what single precision could not hold.
    const std::vector<float> huge{3e38F, 3e38F, 1};
    CHECK(detail::largest_sum(huge.data(), 1, 2, 10) == doctest::Approx(6e39));
}
