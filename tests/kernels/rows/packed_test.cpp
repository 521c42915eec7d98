#include <tactnet/kernels/rows/packed.hpp>
#include <tactnet/runtime/random.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <support/tolerance.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

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
