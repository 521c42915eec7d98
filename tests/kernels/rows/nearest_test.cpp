#include <tactnet/kernels/rows/nearest.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <support/whole_numbers.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

template <std::size_t Values>
void compare(std::size_t rows, std::size_t points) {
    CAPTURE(rows);
    CAPTURE(points);
    const auto matrix = support::whole_numbers<float>(rows * Values, 7919),
               from = support::whole_numbers<float>(points * Values, 104729);
    std::vector<std::uint32_t> found(points + 1, 12345);
    const nearest_row<Values> search(matrix);
    search.find(from.data(), points, found.data());
    for (std::size_t i = 0; i < points; ++i) {
        std::size_t expected = 0;
        float least = std::numeric_limits<float>::infinity();
        for (std::size_t r = 0; r < rows; ++r) {
            float distance = 0;
            for (std::size_t v = 0; v < Values; ++v) {
                const float d = matrix[r * Values + v] - from[i * Values + v];
                distance += d * d;
            }
            if (distance < least) // the first of several, of which there are many here
                least = distance, expected = r;
        }
        CHECK(found[i] == expected);
    }
    CHECK(found[points] == 12345);
}

} // namespace

TEST_CASE("nearest_row: against plain loops, ties included") {
    for (const std::size_t rows : {1u, 2u, 16u, 63u, 64u, 65u, 200u})
        for (const std::size_t points : {0u, 1u, 5u, 6u, 47u, 48u, 49u, 101u})
            compare<3>(rows, points);
    compare<64>(500, 340);
    compare<1>(20, 20);
}

TEST_CASE("nearest_row: no rows, and points that are not numbers") {
    std::uint32_t index = 7;
    const float broken[2] = {std::numeric_limits<float>::quiet_NaN(), 0};
    nearest_row<2>().find(broken, 1, &index);
    CHECK(index == 0);
    const std::vector<float> rows{1, 2, 3, 4};
    index = 7;
    nearest_row<2> search(rows);
    search.find(broken, 1, &index);
    CHECK(index == 0);
}

TEST_CASE("nearest_row: far away, where squares still hold") {
    std::vector<float> rows(40 * 64, -1e17f);
    std::fill_n(rows.begin() + 39 * 64, 64, 1e17f);
    const std::vector<float> point(64, 9e16f);
    std::uint32_t index = 0;
    nearest_row<64> search(rows);
    search.find(point.data(), 1, &index);
    CHECK(index == 39);
}
