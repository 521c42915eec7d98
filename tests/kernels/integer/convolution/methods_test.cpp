#include "../comparison.hpp"

#include <doctest/doctest.h>

using namespace integer_test;

// Depthwise convolutions of bytes: the same sums as those of the direct method.

namespace {

template <frame_convolution C, class Output = std::uint8_t>
std::size_t depthwise_differing(numbers_are kind = numbers_are::drawn) {
    using scalar = kernels::scalar_depthwise_method<C, std::uint8_t>;
    using in_lanes = kernels::depthwise_integer_method<C, std::uint8_t>;
    static_assert(scalar::applicable || in_lanes::applicable);
    std::size_t wrong = differing<scalar, C, std::uint8_t, Output>(kind);
    if constexpr (in_lanes::applicable)
        wrong += differing<in_lanes, C, std::uint8_t, Output>(kind);
    return wrong;
}
template <frame_convolution... C>
std::size_t all_differing() {
    return (depthwise_differing<C>() + ...);
}
/// As many filters as channels; pixels of the input lie as a step writes them, or closer.
constexpr frame_convolution each(shape input, extent2d kernel, extent2d stride = 1,
                                 padding around = padding::same, std::size_t input_stride = 0) {
    return depthwise(of(input, input.channels, kernel, stride, around, input_stride));
}

} // namespace

TEST_CASE(
    "depthwise_integer_method: kernels of 1 to 7 and any number of channels give the sums of plain loops") {
    CHECK(all_differing<each({5, 6, 2}, 3), each({6, 7, 3}, 1), each({6, 5, 4}, 2), each({7, 6, 5}, 4),
                        each({7, 9, 8}, 5), each({8, 9, 12}, 6), each({9, 8, 16}, 7)>() == 0);
    CHECK(all_differing<each({5, 6, 17}, 3), each({4, 5, 24}, 3), each({5, 3, 33}, 3), each({3, 4, 64}, 3),
                        each({6, 4, 70}, extent2d(2, 3)), each({3, 5, 130}, extent2d(3, 5))>() == 0);
    // The last vector of bytes is half full, with any number of lanes.
    CHECK(all_differing<each({5, 6, 24}, 3), each({4, 5, 48}, 3), each({5, 6, 96}, 3)>() == 0);
}

TEST_CASE("depthwise_integer_method: strides and pads give the sums of plain loops") {
    CHECK(all_differing<each({9, 8, 6}, 3, 2), each({9, 8, 32}, 5, extent2d(2, 3), pad(2)),
                        each({8, 9, 20}, 2, extent2d(3, 1), padding::valid),
                        each({7, 7, 9}, 3, 2, pad(1, 0, 2, 1)), each({5, 4, 64}, 4, 3, pad(3)),
                        each({5, 6, 7}, 1, 2, padding::valid), each({3, 2, 16}, 3, 1, pad(2))>() == 0);
}

TEST_CASE("depthwise_integer_method: lanes between pixels are not looked at") {
    CHECK(all_differing<each({5, 6, 3}, 3, 1, padding::same, 4), each({5, 6, 5}, 3, 1, padding::same, 8),
                        each({4, 5, 40}, 2, 1, padding::same, 64)>() == 0);
}

TEST_CASE("depthwise_integer_method: pools, sums, wider maps and floats") {
    CHECK(all_differing<pooled(each({8, 6, 4}, 3), 2, 4, 3), pooled(each({7, 9, 18}, 3), 2, 4, 5),
                        pooled(each({9, 7, 8}, 2), 3, 3, 2, false),
                        pooled(each({6, 9, 64}, 5), extent2d(1, 2), 6, 4)>() == 0);
    CHECK(all_differing<adding(each({5, 7, 4}, 3)), adding(each({5, 7, 13}, 3), true),
                        adding(each({4, 4, 40}, 1))>() == 0);
    CHECK(all_differing<among(each({4, 5, 8}, 3), 32, 16), among(each({4, 5, 4}, 3), 16, 12),
                        among(pooled(each({6, 5, 12}, 3), 2, 3, 2), 32, 4)>() == 0);
    CHECK(depthwise_differing<each({4, 3, 22}, 3), float>() == 0);
    CHECK(depthwise_differing<pooled(each({5, 6, 6}, 3), 2, 2, 3), float>() == 0);
}

TEST_CASE(
    "depthwise_integer_method: the largest bytes and weights neither overflow nor saturate on the way") {
    CHECK(depthwise_differing<each({3, 3, 16}, 3)>(numbers_are::largest) == 0);
    CHECK(depthwise_differing<each({4, 4, 64}, 5)>(numbers_are::largest) == 0);
}

// Tiles in integers: the same sums as those of the direct method.

namespace {

/// By tiles of so many outputs, or by the tile that is chosen.
template <frame_convolution C, extent2d Outputs = extent2d(0), class Output = std::uint8_t>
std::size_t tiles_differing(numbers_are kind = numbers_are::drawn) {
    constexpr extent2d tile = Outputs == extent2d(0) ? kernels::best_integer_tile(C.ungrouped()) : Outputs;
    if constexpr (kernels::max_integer_lanes > 1 && tile.rows > 0) {
        static_assert(kernels::integer_tiling{C.ungrouped(), tile}.possible());
        return differing<kernels::integer_tile_method<C, tile>, C, std::uint8_t, Output>(kind);
    } else {
        return 0;
    }
}
constexpr bool possible(frame_convolution c, extent2d outputs) {
    return kernels::integer_tiling{c, outputs}.possible();
}

} // namespace

TEST_CASE("winograd_integer_method: tiles of every size for 3 x 3 give the sums of plain loops") {
    // Edges of the map cut tiles on both sides, or on one, or on none.
    constexpr frame_convolution c = of({7, 9, 16}, 20, 3);
    CHECK(tiles_differing<c, extent2d(2)>() == 0);
    CHECK(tiles_differing<c, extent2d(2, 3)>() == 0);
    CHECK(tiles_differing<c, extent2d(2, 4)>() == 0);
    CHECK(tiles_differing<c, extent2d(3, 2)>() == 0);
    CHECK(tiles_differing<c, extent2d(3)>() == 0);
    CHECK(tiles_differing<of({6, 12, 64}, 64, 3), extent2d(3, 4)>() == 0);
    CHECK(tiles_differing<c, extent2d(4, 2)>() == 0);
    CHECK(tiles_differing<c, extent2d(4, 3)>() == 0);
    CHECK(tiles_differing<c, extent2d(4)>() == 0);
    // 32 tiles of 64 channels, whose elements would lie whole pages apart.
    CHECK(tiles_differing<of({16, 32, 64}, 16, 3), extent2d(4)>() == 0);
}

TEST_CASE("winograd_integer_method: tiles of every size for 2 x 2 give the sums of plain loops") {
    constexpr frame_convolution c = of({9, 11, 12}, 17, 2);
    CHECK(tiles_differing<c, extent2d(2)>() == 0);
    CHECK(tiles_differing<c, extent2d(3)>() == 0);
    CHECK(tiles_differing<c, extent2d(2, 4)>() == 0);
    CHECK(tiles_differing<c, extent2d(4, 5)>() == 0);
    CHECK(tiles_differing<c, extent2d(5, 3)>() == 0);
    CHECK(tiles_differing<c, extent2d(5)>() == 0);
}

TEST_CASE("winograd_integer_method: pads, lanes between pixels, groups and the chosen tile") {
    CHECK(tiles_differing<of({7, 5, 16}, 33, 3)>() == 0);
    CHECK(tiles_differing<of({4, 9, 4}, 16, 3, 1, pad(2))>() == 0);
    CHECK(tiles_differing<of({4, 9, 4}, 16, 3, 1, pad(2)), extent2d(4)>() == 0);
    CHECK(tiles_differing<of({5, 6, 5}, 8, 3, 1, padding::valid, 8)>() == 0);
    CHECK(tiles_differing<of({5, 6, 5}, 8, 3, 1, padding::valid, 8), extent2d(3, 4)>() == 0);
    CHECK(tiles_differing<grouped(of({5, 6, 8}, 8, 3), 2), extent2d(3, 4)>() == 0);
}

TEST_CASE("winograd_integer_method: pools, sums, wider maps and floats") {
    CHECK(tiles_differing<pooled(of({7, 9, 8}, 16, 3), 2, 4, 5)>() == 0);
    CHECK(tiles_differing<pooled(of({7, 9, 8}, 16, 3), 2, 4, 5), extent2d(2, 4)>() == 0);
    CHECK(tiles_differing<pooled(of({7, 9, 8}, 16, 3), 2, 3, 4), extent2d(4)>() == 0);
    CHECK(tiles_differing<pooled(of({7, 9, 8}, 8, 2), 2, 3, 4, false)>() == 0);
    CHECK(tiles_differing<adding(of({5, 7, 4}, 8, 3), true)>() == 0);
    CHECK(tiles_differing<adding(of({5, 7, 4}, 8, 3), true), extent2d(3, 4)>() == 0);
    CHECK(tiles_differing<among(of({4, 5, 4}, 8, 3), 32, 16)>() == 0);
    CHECK(tiles_differing<among(of({4, 5, 4}, 8, 3), 32, 16), extent2d(4)>() == 0);
    CHECK(tiles_differing<pooled(of({5, 6, 4}, 6, 3), 1, 5, 6), extent2d(3), float>() == 0);
}

TEST_CASE("winograd_integer_method: the largest bytes and weights, as many as a tile takes") {
    constexpr auto channels = [](std::size_t count) { return of({5, 6, count}, 4, 3); };
    static_assert(possible(channels(1024), extent2d(2)) == (kernels::max_integer_lanes > 1));
    static_assert(possible(channels(460), extent2d(3, 4)) == (kernels::max_integer_lanes > 1));
    static_assert(possible(channels(112), extent2d(4)) == (kernels::max_integer_lanes > 1));
    // Outputs before the division need more than 32 bits: what was lost would show.
    static_assert(!possible(channels(464), extent2d(3, 4)) && !possible(channels(116), extent2d(4)));
    CHECK(tiles_differing<channels(1024), extent2d(2)>(numbers_are::largest) == 0);
    CHECK(tiles_differing<channels(460), extent2d(3, 4)>(numbers_are::largest) == 0);
    CHECK(tiles_differing<channels(112), extent2d(4)>(numbers_are::largest) == 0);
    CHECK(tiles_differing<of({6, 6, 256}, 4, 2), extent2d(5)>(numbers_are::largest) == 0);
}

// Dense layers: the same sums as those of the direct method.

namespace {

template <shape Input, std::size_t Outputs, std::size_t Stride = Input.channels, class Output = std::uint8_t,
          bool Relu = false>
std::size_t dense_differing(numbers_are kind = numbers_are::drawn) {
    constexpr frame_convolution c{.window = {Input, {Input.rows, Input.columns}, 1},
                                  .filters = Outputs,
                                  .input_stride = Stride,
                                  .activation = Relu ? fused<relu_function> : &kernels::no_activation};
    using method = kernels::dense_integer_method<c, std::uint8_t>;
    if constexpr (method::applicable)
        return differing<method, c, std::uint8_t, Output>(kind);
    else
        return 0;
}

} // namespace

TEST_CASE("dense_integer_method: any number of bytes and outputs gives the sums of plain loops") {
    CHECK(dense_differing<shape{1, 1, 1}, 1>() == 0);
    CHECK(dense_differing<shape{1, 3, 5}, 4>() == 0);
    CHECK(dense_differing<shape{2, 2, 16}, 22>() == 0);
    CHECK(dense_differing<shape{3, 5, 17}, 16>() == 0);
    CHECK(dense_differing<shape{2, 3, 64}, 25>() == 0);
    CHECK(dense_differing<shape{1, 1, 200}, 70>() == 0);
}

TEST_CASE("dense_integer_method: lanes between pixels are not looked at; floats, and the largest numbers") {
    CHECK(dense_differing<shape{2, 3, 5}, 7, 8>() == 0);
    CHECK(dense_differing<shape{3, 1, 20}, 22, 32, float>() == 0);
    CHECK(dense_differing<shape{3, 1, 20}, 22, 32, float, true>() == 0);
    CHECK(dense_differing<shape{4, 4, 128}, 8>(numbers_are::largest) == 0);
}

TEST_CASE("dense_integer_method: only kernels as large as the map") {
    static_assert(!kernels::dense_integer_method<of({3, 4, 8}, 8, 3), std::uint8_t>::applicable);
    static_assert(!kernels::dense_integer_method<of({3, 3, 8}, 8, 3), std::uint8_t>::applicable);
    static_assert(!kernels::dense_integer_method<adding(of({1, 1, 8}, 8, 1)), std::uint8_t>::applicable);
}
