#include <tactnet/kernels/frame/direct.hpp>
#include <tactnet/kernels/frame/packed_pixels.hpp>
#include <tactnet/kernels/frame/winograd.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <support/frame_convolution.hpp>
#include <support/same_bits.hpp>
#include <type_traits>

using namespace tactnet;
using namespace tactnet::kernels;
using support::adding;
using support::pooled;
using support::step;

namespace {

template <frame_convolution C, extent2d Tile = 0>
struct job {
    using method = std::conditional_t<Tile == extent2d(0), direct_method<C>, winograd_method<C, Tile>>;
    static_assert(method::applicable && method::tile == Tile);
    static void run(std::uint64_t seed) { support::convolution_numbers(C, 1, seed).check<method>(); }
};
template <class... Jobs>
void run_all() {
    std::uint64_t seed = 1;
    (Jobs::run(++seed), ...);
}

} // namespace

TEST_CASE("direct_method: sizes, strides and paddings") {
    run_all<job<step({28, 50}, 5, 8, 1)>,                                    //
            job<step({1, 1}, 3, 1, 1)>,                                      //
            job<step({1, 9, 3}, 3, 5, 3)>,                                   //
            job<step({11, 1, 2}, 2, 12, 16)>,                                //
            job<step({5, 7, 3}, extent2d(4, 2), 20, 8)>,                     //
            job<step({9, 8, 2}, 3, 33, 2, 2)>,                               //
            job<step({10, 13}, 5, 3, 1, 2, pad(2))>,                         //
            job<step({6, 7, 5}, extent2d(2, 3), 16, 8, 1, padding::valid)>,  //
            job<step({6, 5, 4}, 3, 40, 4, extent2d(1, 2), pad(0, 2, 1, 0))>, //
            job<step({4, 5, 16}, 1, 64, 16)>>();
}

TEST_CASE("direct_method: pools, ReLU and sums") {
    run_all<job<pooled(step({7, 13}, 5, 8, 1), 2)>,                       //
            job<pooled(step({7, 13, 2}, 3, 12, 16), 2, true)>,            //
            job<pooled(step({8, 11, 3}, 3, 5, 3), extent2d(3, 2))>,       //
            job<pooled(step({5, 9, 2}, 2, 33, 2), extent2d(1, 3), true)>, //
            job<adding(step({5, 6, 12}, 3, 20, 16), true)>,               //
            job<adding(step({3, 9, 4}, 1, 3, 4, 2), false)>>();
}

TEST_CASE("winograd_method: 3 x 3 and 2 x 2 kernels, odd sizes, paddings") {
    run_all<job<step({14, 25, 8}, 3, 16, 8), 2>,                    //
            job<step({7, 13, 16}, 2, 32, 16), 2>,                   //
            job<step({1, 1, 4}, 3, 4, 4), 2>,                       //
            job<step({5, 1, 20}, 3, 5, 32), 2>,                     //
            job<step({1, 6, 3}, 2, 1, 16), 2>,                      //
            job<step({9, 5, 12}, 3, 40, 16, 1, padding::valid), 2>, //
            job<step({6, 7, 5}, 2, 33, 16, 1, pad(1)), 2>,          //
            job<step({6, 7, 4}, 3, 12, 4, 1, pad(2, 0, 1, 2)), 2>>();
}

TEST_CASE("winograd_method: pools, ReLU and sums") {
    run_all<job<pooled(step({7, 13, 16}, 3, 32, 16), 2), 2>,    //
            job<pooled(step({7, 13, 8}, 3, 5, 8), 2, true), 2>, //
            job<pooled(step({5, 9, 12}, 2, 20, 16), 2), 2>,     //
            job<adding(step({7, 9, 20}, 3, 20, 32), true), 2>,  //
            job<adding(step({4, 5, 4}, 2, 12, 4), false), 2>>();
}

TEST_CASE("winograd_method: larger ones, and those that are no squares") {
    run_all<job<step({6, 9, 8}, 3, 20, 8), extent2d(2, 4)>,                   //
            job<step({6, 9, 8}, 3, 20, 8), extent2d(3, 4)>,                   //
            job<step({7, 3, 8}, 3, 8, 8), extent2d(4, 3)>,                    //
            job<step({11, 7, 8}, 2, 36, 8), extent2d(5, 3)>,                  //
            job<step({4, 9, 8}, 2, 8, 8), extent2d(4, 5)>,                    //
            job<step({1, 2, 4}, 3, 4, 4, 1, pad(0, 2, 1, 2)), extent2d(4)>,   //
            job<pooled(step({7, 10, 5}, 3, 8, 16), 2), extent2d(4)>,          //
            job<pooled(step({7, 13, 5}, 2, 8, 16), 2, true), extent2d(2, 4)>, //
            job<adding(step({3, 5, 12}, 3, 64, 16), true), extent2d(3)>>();
}

namespace {

constexpr frame_convolution pixel_step(extent2d image, extent2d kernel, std::size_t filters,
                                       padding around = padding::same) {
    return support::with_relu(support::step({image.rows, image.columns, 1}, kernel, filters, 1, 1, around));
}

/// Runs both methods on the same numbers and returns how many outputs have other bits. NaN lies around all
/// that they may touch, and in the workspace.
template <frame_convolution C>
std::size_t other_bits(std::uint64_t seed) {
    CAPTURE(C.window.input.rows);
    CAPTURE(C.window.input.columns);
    CAPTURE(C.filters);
    support::convolution_numbers numbers(C, 1, seed, NAN);
    return support::numbers_that_differ(numbers.run<direct_method<C>>(),
                                        numbers.run<packed_pixels_method<C>>());
}

template <frame_convolution C>
void compare_bits(std::uint64_t seed) {
    if constexpr (packed_pixels_method<C>::applicable)
        CHECK(other_bits<C>(seed) == 0);
}

/// With as many filters as fill a share of a vector, at least four of them.
template <std::size_t Share>
inline constexpr std::size_t filters = lanes<float> / Share < 4 ? 4 : lanes<float> / Share;

constexpr frame_convolution sparse = [] {
    frame_convolution c = pixel_step({9, 12}, 3, 4);
    c.input_stride = 4;
    return c;
}();

} // namespace

TEST_CASE("packed_pixels_method: the bits of direct_method, whatever the size") {
    compare_bits<pooled(pixel_step({28, 50}, 5, filters<2>), 2)>(1); // TactNet-4 and TactNet-6
    compare_bits<pooled(pixel_step({14, 25}, 3, filters<2>), 2)>(2); // the last pixels are single
    compare_bits<pooled(pixel_step({7, 13}, 5, filters<2>), 2)>(3);
    compare_bits<pixel_step({7, 13}, 5, filters<2>)>(4);
    compare_bits<pixel_step({10, 18}, {2, 3}, filters<2> - 1)>(
        5); // a lane without a filter, a kernel with an even side
    compare_bits<pixel_step({11, 37}, {3, 7}, filters<2>, padding::valid)>(6);
    compare_bits<pixel_step({3, 40}, {5, 1}, filters<2>, pad(2, 2, 0, 0))>(7);
    compare_bits<pixel_step({1, 2}, 1, filters<2>)>(8);
    compare_bits<pooled(pixel_step({13, 60}, 3, filters<4>), 2)>(9);
    compare_bits<pooled(pixel_step({13, 19}, 3, filters<4>), {3, 1})>(10);
    compare_bits<pooled(pixel_step({5, 9}, 3, 3), {1, 2})>(11);
    compare_bits<sparse>(12);
}

TEST_CASE("packed_pixels_method: only for few filters over one channel, one step at a time") {
    constexpr std::size_t few = filters<2>;
    constexpr bool vectors_hold_two = lanes<float> >= 8;
    CHECK(packed_pixels_method<pixel_step({8, 8}, 3, few)>::applicable == vectors_hold_two);
    CHECK_FALSE(packed_pixels_method<pixel_step({8, 8}, 3, 2 * lanes<float>)>::applicable);
    CHECK_FALSE(packed_pixels_method<pixel_step({8, 1}, 3, few)>::applicable);
    CHECK_FALSE(packed_pixels_method<pooled(pixel_step({9, 9}, 3, few), 3)>::applicable);
    constexpr auto changed = [](auto change) {
        frame_convolution c = pixel_step({8, 8}, 3, few);
        change(c);
        return c;
    };
    CHECK_FALSE(packed_pixels_method<changed([](auto& c) { c.accumulates = true; })>::applicable);
    CHECK_FALSE(packed_pixels_method<changed([](auto& c) { c.window.input.channels = 2; })>::applicable);
    CHECK_FALSE(packed_pixels_method<changed([](auto& c) { c.window.stride = 2; })>::applicable);
    CHECK_FALSE(packed_pixels_method<changed([](auto& c) { c.map_stride = 64; })>::applicable);
}
