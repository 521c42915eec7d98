#include <tactnet/kernels/rows/weighted_sum.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <support/whole_numbers.hpp>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

template <std::size_t Length>
void compare_sums() {
    constexpr std::size_t stride = 2 * Length;
    const auto rows = support::whole_numbers<float>(5 * stride, 7919),
               weights = support::whole_numbers<float>(5, 104729);
    for (std::size_t count = 0; count <= 5; ++count) {
        aligned_vector<float> found(Length + 16, 99), expected(Length);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t v = 0; v < Length; ++v)
                expected[v] += weights[i] * rows[i * stride + v];
        weighted_sum<Length>(rows.data(), stride, weights.data(), count, found.data());
        CHECK(std::equal(expected.begin(), expected.end(), found.begin()));
        CHECK(found[Length] == 99);
    }
}

} // namespace

TEST_CASE("weighted_sum: against plain loops") {
    compare_sums<4>();
    compare_sums<16>();
    compare_sums<208>();
}

TEST_CASE("weighted_sum: lengths, and values scaled, of whole vectors") {
    aligned_vector<float> values(80);
    for (std::size_t i = 0; i < 64; ++i)
        values[i] = i % 2 == 0 ? 3.0f : -4.0f; // 32 × 25 = 800 = 2 × 20²
    values[64] = 1e9f;
    CHECK(length_of<64>(values.data()) == std::sqrt(800.0f));
    CHECK(length_of<4>(values.data()) == std::sqrt(50.0f));
    scale_values<64>(values.data(), -0.5f);
    CHECK(values[0] == -1.5f);
    CHECK(values[63] == 2.0f);
    CHECK(values[64] == 1e9f);
}
