#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/kernels/rows/packed.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <support/guarded_map.hpp>
#include <support/tolerance.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

template <std::size_t Values>
void compare_nearest(std::size_t rows, std::size_t points) {
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
            compare_nearest<3>(rows, points);
    compare_nearest<64>(500, 340);
    compare_nearest<1>(20, 20);
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

namespace {

std::vector<float> random_values(std::size_t count, std::uint64_t seed) {
    random_stream random(seed, random_purposes::order);
    std::vector<float> values(count);
    for (float& value : values)
        value = static_cast<float>(random.uniform(-1, 1));
    return values;
}

} // namespace

TEST_CASE("packed: products against double precision, for sizes around those of blocks and panels") {
    constexpr std::size_t width = packed_rows::panel_width;
    for (const std::size_t features : {std::size_t{1}, std::size_t{127}, std::size_t{128}, std::size_t{1400}})
        for (const std::size_t columns : {std::size_t{1}, width, width + 1}) {
            const std::size_t count = packed_rows::block_rows + 1;
            const std::vector<float> a = random_values(count * features, 1),
                                     b = random_values(columns * features, 2);
            const packed_rows packed(columns, features,
                                     [&](std::size_t j) { return b.data() + j * features; });
            REQUIRE(packed.padded_rows() % width == 0);
            const std::size_t stride = packed.padded_rows();
            aligned_vector<float> found(count * stride, 99);
            packed.products(a.data(), count, features, found.data(), stride);
            // A product goes through as many roundings as a run has terms, and as there are runs.
            const double roundings = 128.0 + static_cast<double>(features) / 128 + 1;
            bool right = true, zero_behind = true;
            for (std::size_t i = 0; i < count; ++i)
                for (std::size_t j = 0; j < stride; ++j) {
                    double sum = 0, size = 0;
                    for (std::size_t f = 0; j < columns && f < features; ++f) {
                        const double term = static_cast<double>(a[i * features + f]) *
                                            static_cast<double>(b[j * features + f]);
                        sum += term;
                        size += std::abs(term);
                    }
                    const double error =
                        support::accumulated(support::unit_roundoff<float>, roundings) * size;
                    right =
                        right && support::within(static_cast<double>(found[i * stride + j]), {sum, error});
                    zero_behind = zero_behind && (j < columns || found[i * stride + j] == 0);
                }
            CAPTURE(features);
            CAPTURE(columns);
            CHECK(right);
            CHECK(zero_behind);
        }
}

TEST_CASE("packed: a row alone gives the bits that it gives in a batch") {
    constexpr std::size_t features = 300, columns = 40, count = 2 * packed_rows::block_rows;
    const std::vector<float> a = random_values(count * features, 3), b = random_values(columns * features, 4);
    const packed_rows packed(columns, features, [&](std::size_t j) { return b.data() + j * features; });
    const std::size_t stride = packed.padded_rows();
    aligned_vector<float> batch(count * stride), alone(stride);
    packed.products(a.data(), count, features, batch.data(), stride);
    for (std::size_t i = 0; i < count; ++i) {
        packed.products(a.data() + i * features, 1, features, alone.data(), stride);
        CHECK(
            std::equal(alone.begin(), alone.end(), batch.begin() + static_cast<std::ptrdiff_t>(i * stride)));
    }
}

namespace {

/// Each term is rounded twice, and a sum at most once per row.
template <std::size_t Rows, std::size_t Columns>
void check_sums() {
    std::mt19937 random(Rows * 100 + Columns);
    std::normal_distribution<float> normal;
    const auto draw = [&](std::size_t count) {
        std::vector<float> values(count);
        for (float& value : values)
            value = normal(random);
        return values;
    };
    const auto weights = draw(Rows), rows = draw(Rows * Columns + 1), before = draw(Columns);
    auto sums = before;
    add_weighted_rows<Rows, Columns>(weights.data(), rows.data() + 1, sums.data()); // of any alignment
    for (std::size_t c = 0; c < Columns; ++c) {
        auto expected = static_cast<double>(before[c]);
        double magnitude = std::abs(expected);
        for (std::size_t r = 0; r < Rows; ++r) {
            const double term =
                static_cast<double>(weights[r]) * static_cast<double>(rows[r * Columns + c + 1]);
            expected += term;
            magnitude += std::abs(term);
        }
        constexpr double rounding = std::numeric_limits<float>::epsilon() / 2;
        CHECK(std::abs(static_cast<double>(sums[c]) - expected) <= (Rows + 2) * rounding * magnitude);
    }
}

} // namespace

TEST_CASE("add_weighted_rows: sums of rows of any length and number") {
    check_sums<1, 1>();
    check_sums<2, 3>();
    check_sums<7, 8>();
    check_sums<256, 16>();
    check_sums<257, 21>();
    check_sums<31, 40>();
    check_sums<9, 67>();
}
