#include "../comparison.hpp"

#include <doctest/doctest.h>

using namespace integer_test;

// Inputs of bytes, as between the steps of a network in 8 bits.

namespace {

template <frame_convolution C, class Input>
std::size_t floats_differing() {
    return differing<kernels::direct_integer_method<C, Input>, C, Input, float>();
}

} // namespace

TEST_CASE(
    "direct_integer_method: kernels of 1 to 7 and any number of channels give the sums of plain loops") {
    CHECK(direct_differing<std::uint8_t, of({5, 6, 1}, 1, 1), of({5, 6, 1}, 8, 3), of({6, 7, 2}, 3, 2),
                           of({6, 5, 3}, 5, 4), of({7, 6, 4}, 12, 5), of({7, 9, 5}, 16, 6),
                           of({8, 9, 8}, 4, 7)>() == 0);
    CHECK(direct_differing<std::uint8_t, of({5, 6, 12}, 16, 3), of({4, 5, 16}, 17, 3), of({4, 3, 33}, 40, 3),
                           of({3, 4, 33}, 2, extent2d(2, 3)), of({1, 1, 5}, 33, 1),
                           of({3, 5, 2}, 24, extent2d(3, 5), 1, padding::valid)>() == 0);
}

TEST_CASE("direct_integer_method: strides and pads give the sums of plain loops") {
    CHECK(direct_differing<std::uint8_t, of({9, 8, 3}, 7, 3, 2), of({9, 8, 1}, 9, 5, extent2d(2, 3), pad(2)),
                           of({8, 9, 4}, 8, 2, extent2d(3, 1), padding::valid),
                           of({7, 7, 8}, 33, 3, 2, pad(1, 0, 2, 1)), of({5, 4, 2}, 4, 4, 3, pad(3))>() == 0);
}

TEST_CASE("direct_integer_method: lanes between pixels are not looked at") {
    CHECK(
        direct_differing<std::uint8_t, of({5, 6, 3}, 5, 3, 1, padding::same, 4),
                         of({5, 6, 5}, 16, 3, 1, padding::same, 8), of({4, 5, 9}, 8, 2, 1, padding::same, 16),
                         of({4, 5, 1}, 8, 3, 2, padding::same, 16)>() == 0);
}

TEST_CASE("direct_integer_method: a pool takes the largest sum, also of cut windows") {
    CHECK(direct_differing<std::uint8_t, pooled(of({8, 6, 4}, 8, 3), 2, 4, 3),
                           pooled(of({7, 9, 2}, 16, 3), 2, 4, 5), pooled(of({7, 9, 2}, 16, 3), 2, 3, 4),
                           pooled(of({9, 7, 8}, 5, 2), 3, 3, 2, false),
                           pooled(of({6, 9, 1}, 33, 5), extent2d(1, 2), 6, 4)>() == 0);
}

TEST_CASE("direct_integer_method: rows of padding are left out only if their bytes stand for zero") {
    CHECK(direct_differing<std::uint8_t, pooled(of({7, 6, 33}, 16, 3), 2, 4, 3),
                           pooled(of({8, 4, 33}, 17, 3), 2, 4, 2), pooled(of({2, 4, 33}, 18, 3), 2, 1, 2),
                           pooled(of({2, 4, 33}, 19, 3), 2, 1, 2), pooled(of({5, 4, 64}, 16, 2), 2, 3, 2),
                           pooled(of({5, 4, 64}, 17, 2), 2, 3, 2)>() == 0);
}

TEST_CASE("direct_integer_method: accumulates onto the output") {
    CHECK(direct_differing<std::uint8_t, adding(of({5, 7, 4}, 8, 3)), adding(of({5, 7, 3}, 13, 3), true),
                           adding(of({4, 4, 16}, 40, 1))>() == 0);
}

TEST_CASE("direct_integer_method: in a wider map only its own channels are written") {
    CHECK(
        direct_differing<std::uint8_t, among(of({4, 5, 4}, 8, 3), 32, 16), among(of({4, 5, 3}, 4, 1), 16, 12),
                         among(pooled(of({6, 5, 4}, 12, 3), 2, 3, 2), 32, 4)>() == 0);
}

TEST_CASE("direct_integer_method: groups are one convolution with zeros between them") {
    CHECK(direct_differing<std::uint8_t, grouped(of({5, 6, 8}, 12, 3), 2), grouped(of({6, 4, 9}, 6, 2), 3),
                           depthwise(of({5, 4, 7}, 7, 3))>() == 0);
}

TEST_CASE("direct_integer_method: float outputs are sum times factor, not below zero after ReLU") {
    CHECK(floats_differing<of({1, 1, 33}, 22, 1), std::uint8_t>() == 0);
    CHECK(floats_differing<pooled(of({5, 6, 4}, 6, 3), 2, 2, 3), std::uint8_t>() == 0);
    CHECK(floats_differing<pooled(of({5, 6, 2}, 9, 3), 1, 5, 6), std::int16_t>() == 0);
}

TEST_CASE("direct_integer_method: the largest bytes and weights neither overflow nor saturate on the way") {
    std::size_t saturated = 0, outputs = 0;
    const auto both = [&]<frame_convolution C>(std::integral_constant<frame_convolution, C>) {
        outputs += 2 * C.filters * C.output_rows() * C.output_columns();
        return differing<kernels::direct_integer_method<C, std::uint8_t>, C, std::uint8_t>(
            numbers_are::largest, &saturated);
    };
    CHECK(both(std::integral_constant<frame_convolution, of({3, 4, 33}, 6, 7)>{}) == 0);
    CHECK(both(std::integral_constant<frame_convolution, of({3, 3, 16}, 16, 3)>{}) == 0);
    CHECK(both(std::integral_constant<frame_convolution, of({4, 4, 1}, 8, 5)>{}) == 0);
    CHECK(both(std::integral_constant<frame_convolution,
                                      of({10, 18, 128}, 4, extent2d(10, 18), 1, padding::valid)>{}) == 0);
    CHECK(saturated < outputs / 4); // else the bytes would not show the sums
}

// Inputs of 16 bits with a sign, as a network in 8 bits reads them from a sensor.

TEST_CASE("direct_integer_method: words and kernels of 1 to 7 give the sums of plain loops") {
    CHECK(direct_differing<std::int16_t, of({5, 6, 1}, 1, 1), of({5, 6, 1}, 8, 3), of({6, 7, 2}, 3, 2),
                           of({6, 5, 3}, 5, 4), of({7, 6, 4}, 12, 5), of({7, 9, 5}, 16, 6),
                           of({8, 9, 1}, 40, 7)>() == 0);
    CHECK(direct_differing<std::int16_t, of({9, 8, 3}, 7, 3, 2), of({9, 8, 1}, 9, 5, extent2d(2, 3), pad(2)),
                           of({5, 6, 3}, 5, 3, 1, padding::same, 4),
                           of({4, 5, 1}, 8, 2, 1, padding::valid, 16)>() == 0);
}

TEST_CASE("direct_integer_method: words with pools, sums and wider maps") {
    CHECK(direct_differing<std::int16_t, pooled(of({8, 6, 1}, 8, 5), 2, 4, 3),
                           pooled(of({7, 9, 2}, 16, 3), 2, 4, 5), adding(of({5, 7, 4}, 8, 3)),
                           among(of({4, 5, 4}, 8, 3), 32, 16)>() == 0);
}

TEST_CASE("direct_integer_method: the largest words and weights neither overflow nor saturate on the way") {
    for (const numbers_are kind : {numbers_are::largest, numbers_are::smallest}) {
        CHECK(direct_differing<std::int16_t, of({6, 7, 1}, 8, 5)>(kind) == 0);
        CHECK(direct_differing<std::int16_t, of({4, 4, 3}, 16, 3)>(kind) == 0);
        CHECK(direct_differing<std::int16_t, of({5, 5, 2}, 5, 2)>(kind) == 0);
    }
}
