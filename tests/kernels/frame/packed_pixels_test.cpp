#include <tactnet/kernels/frame/direct.hpp>
#include <tactnet/kernels/frame/packed_pixels.hpp>

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <support/guarded_map.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

constexpr frame_convolution step(extent2d image, extent2d kernel, std::size_t filters,
                                 padding around = padding::same) {
    return {.window = sliding_window::over({image.rows, image.columns, 1}, kernel, 1, around),
            .filters = filters,
            .input_stride = 1,
            .relu = true};
}
/// Behind it a max pool of windows side by side, of which the last ones may be cut.
constexpr frame_convolution pooled(frame_convolution c, extent2d pool) {
    c.pool = pool;
    c.pooled_rows = (c.window.output_rows() + pool.rows - 1) / pool.rows;
    c.pooled_columns = (c.window.output_columns() + pool.columns - 1) / pool.columns;
    return c;
}

/// Runs both methods on the same numbers and returns how many outputs have other bits. NaN lies around all
/// that they may touch, and in the workspace.
template <frame_convolution C>
std::size_t other_bits(std::uint64_t seed) {
    CAPTURE(C.window.input.rows);
    CAPTURE(C.window.input.columns);
    CAPTURE(C.filters);
    const auto weight = [](std::size_t f, std::size_t, std::size_t row, std::size_t column) {
        return static_cast<float>(std::sin(static_cast<double>(1 + f * 31 + row * 7 + column)));
    };
    support::guarded_map input(C.window.input.area() * C.input_stride, NAN, NAN);
    std::uint64_t state = seed;
    for (std::size_t p = 0; p < C.window.input.area(); ++p)
        input.data()[p * C.input_stride] = support::draw(state);

    const std::size_t outputs = C.output_rows() * C.output_columns() * C.output_stride();
    support::guarded_map expected(outputs, 1, NAN), found(outputs, 2, NAN);
    std::vector<float> biases(C.filters);
    for (std::size_t f = 0; f < C.filters; ++f)
        biases[f] = 0.25f * static_cast<float>(f) - 1;
    const auto run = [&]<class Method>(std::type_identity<Method>, support::guarded_map& to) {
        support::guarded_map packed(Method::packed_elements, 3, 0),
            workspace(Method::workspace_elements, 4, NAN);
        Method::pack(weight, biases.data(), packed.data());
        Method::run(packed.data(), input.data(), to.data(), workspace.data());
        CHECK(packed.untouched());
        CHECK(workspace.untouched());
        CHECK(to.untouched());
    };
    run(std::type_identity<direct_method<C>>{}, expected);
    run(std::type_identity<packed_pixels_method<C>>{}, found);
    std::size_t other = 0;
    for (std::size_t i = 0; i < outputs; ++i)
        other +=
            std::bit_cast<std::uint32_t>(expected.data()[i]) != std::bit_cast<std::uint32_t>(found.data()[i]);
    return other;
}

template <frame_convolution C>
void compare(std::uint64_t seed) {
    if constexpr (packed_pixels_method<C>::applicable)
        CHECK(other_bits<C>(seed) == 0);
}

/// With as many filters as fill a share of a vector, at least four of them.
template <std::size_t Share>
inline constexpr std::size_t filters = lanes<float> / Share < 4 ? 4 : lanes<float> / Share;

constexpr frame_convolution sparse = [] {
    frame_convolution c = step({9, 12}, 3, 4);
    c.input_stride = 4;
    return c;
}();

} // namespace

TEST_SUITE("kernels") {
    TEST_CASE("packed_pixels_method: the bits of direct_method, whatever the size") {
        compare<pooled(step({28, 50}, 5, filters<2>), 2)>(1); // TactNet-4 and TactNet-6
        compare<pooled(step({14, 25}, 3, filters<2>), 2)>(2); // the last pixels are single
        compare<pooled(step({7, 13}, 5, filters<2>), 2)>(3);
        compare<step({7, 13}, 5, filters<2>)>(4);
        compare<step({10, 18}, {2, 3}, filters<2> - 1)>(
            5); // a lane without a filter, a kernel with an even side
        compare<step({11, 37}, {3, 7}, filters<2>, padding::valid)>(6);
        compare<step({3, 40}, {5, 1}, filters<2>, pad(2, 2, 0, 0))>(7);
        compare<step({1, 2}, 1, filters<2>)>(8);
        compare<pooled(step({13, 60}, 3, filters<4>), 2)>(9);
        compare<pooled(step({13, 19}, 3, filters<4>), {3, 1})>(10);
        compare<pooled(step({5, 9}, 3, 3), {1, 2})>(11);
        compare<sparse>(12);
    }

    TEST_CASE("packed_pixels_method: only for few filters over one channel, one step at a time") {
        constexpr std::size_t few = filters<2>;
        constexpr bool vectors_hold_two = lanes<float> >= 8;
        CHECK(packed_pixels_method<step({8, 8}, 3, few)>::applicable == vectors_hold_two);
        CHECK_FALSE(packed_pixels_method<step({8, 8}, 3, 2 * lanes<float>)>::applicable);
        CHECK_FALSE(packed_pixels_method<step({8, 1}, 3, few)>::applicable);
        CHECK_FALSE(packed_pixels_method<pooled(step({9, 9}, 3, few), 3)>::applicable);
        constexpr auto changed = [](auto change) {
            frame_convolution c = step({8, 8}, 3, few);
            change(c);
            return c;
        };
        CHECK_FALSE(packed_pixels_method<changed([](auto& c) { c.accumulates = true; })>::applicable);
        CHECK_FALSE(packed_pixels_method<changed([](auto& c) { c.window.input.channels = 2; })>::applicable);
        CHECK_FALSE(packed_pixels_method<changed([](auto& c) { c.window.stride = 2; })>::applicable);
        CHECK_FALSE(packed_pixels_method<changed([](auto& c) { c.map_stride = 64; })>::applicable);
    }
}
