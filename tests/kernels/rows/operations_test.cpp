#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/tensor/aligned.hpp>

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

template <std::size_t Length>
void compare_distances() {
    const auto a = support::whole_numbers<float>(Length, 7919),
               b = support::whole_numbers<float>(Length, 104729);
    float expected = 0;
    for (std::size_t i = 0; i < Length; ++i)
        expected += (a[i] - b[i]) * (a[i] - b[i]);
    CHECK(squared_distance<Length>(a.data(), b.data()) == expected);
    CHECK(squared_distance<Length>(a.data(), a.data()) == 0);
}

} // namespace

TEST_CASE("weighted_sum: against plain loops") {
    compare_sums<4>();
    compare_sums<16>();
    compare_sums<208>();
}

TEST_CASE("euclidean_norm: whole vectors, scaled by scale_row") {
    aligned_vector<float> values(80);
    for (std::size_t i = 0; i < 64; ++i)
        values[i] = i % 2 == 0 ? 3.0f : -4.0f; // 32 × 25 = 800 = 2 × 20²
    values[64] = 1e9f;
    CHECK(euclidean_norm<64>(values.data()) == std::sqrt(800.0f));
    CHECK(euclidean_norm<4>(values.data()) == std::sqrt(50.0f));
    scale_row<64>(values.data(), -0.5f);
    CHECK(values[0] == -1.5f);
    CHECK(values[63] == 2.0f);
    CHECK(values[64] == 1e9f);
}

TEST_CASE("squared_distance: against plain loops") {
    compare_distances<lanes<float>>();
    compare_distances<64>();
    compare_distances<5 * lanes<float>>();
}
