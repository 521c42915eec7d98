#include <tactnet/kernels/frame/methods.hpp>
#include <tactnet/kernels/frame/winograd.hpp>
#include <tactnet/kernels/method_list.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <support/frame_convolution.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet::kernels;
using namespace tactnet;
using support::adding;
using support::pooled;
using support::step;

namespace {

template <std::size_t Cost, char Letter = 'a'>
struct method {
    static constexpr char name[]{Letter, '\0'};
    static constexpr bool applicable = true;
    static constexpr std::size_t product_twentieths = Cost;
};
/// Its cost must not be read.
template <class Description>
struct inapplicable_method {
    static constexpr const char* name = "inapplicable";
    static constexpr bool applicable = false;
    static constexpr std::size_t product_twentieths = Description::missing;
};

} // namespace

TEST_CASE("method_list: chooses the cheapest applicable method, the first of equals") {
    CHECK(std::is_same_v<method_list<method<3>, method<2>, method<4>>::cheapest, method<2>>);
    CHECK(std::is_same_v<method_list<method<2, 'a'>, method<2, 'b'>>::cheapest, method<2, 'a'>>);
    CHECK(std::is_same_v<method_list<inapplicable_method<int>, method<5>>::cheapest, method<5>>);
    CHECK(std::is_same_v<method_list<method<5>, inapplicable_method<int>>::cheapest, method<5>>);
}

TEST_CASE("method_list: for_each_applicable visits methods in the order of the list") {
    std::string names;
    method_list<method<3, 'x'>, inapplicable_method<int>, method<1, 'y'>>::for_each_applicable(
        [&]<class Method>(std::type_identity<Method>) { names += Method::name; });
    CHECK(names == "xy");
}

namespace {

/// The tile of the chosen method, 0 for one without tiles.
template <frame_convolution C>
constexpr extent2d chosen_tile = convolution_method<C>::tile;

} // namespace

TEST_CASE("convolution_method: Winograd where it saves, and large tiles for wide vectors alone") {
    constexpr bool wide = lanes<float> >= 8;
    // A few pixels or channels are taps; a wide map of many channels is tiles.
    CHECK(chosen_tile<step({1, 2, 64}, 3, 128, 64)> == extent2d(0));
    CHECK(chosen_tile<step({28, 50}, 5, 8, 1)> == extent2d(0));
    CHECK(chosen_tile<step({28, 50, 8}, 3, 16, 8, 2)> == extent2d(0));
    const extent2d large = chosen_tile<step({10, 18, 32}, 3, 64, 32)>;
    CHECK(large == (wide ? extent2d(4, 3) : extent2d(2)));
    CHECK(chosen_tile<step({10, 18, 64}, 2, 128, 64)> == (wide ? extent2d(5, 3) : extent2d(2)));
    // Transforms with points at roots cost more, so that here two rows are better than four.
    constexpr bool widest = lanes<float> == 16;
    CHECK(chosen_tile<pooled(step({14, 25, 8}, 3, 16, 8), 2)> == (widest ? extent2d(2, 4)
                                                                  : wide ? extent2d(4)
                                                                         : extent2d(2)));
    // Four tiles that share a weight are enough for a register block.
    if (widest)
        CHECK(chosen_tile<pooled(step({4, 7, 8}, 3, 16, 8), 2)> == extent2d(2, 4));
    // Weights beyond the second level: fewer of them, though more tiles.
    CHECK(chosen_tile<step({6, 12, 128}, 3, 128, 128)> == (wide ? extent2d(2, 4) : extent2d(2)));
    CHECK_FALSE(tile_possible(step({6, 12, 128}, 3, 128, 128), {1, 3}));
    // A window of a pool lies in one tile.
    const extent2d behind = chosen_tile<pooled(step({7, 13, 64}, 2, 128, 64), 2)>;
    CHECK(behind.rows % 2 == 0);
    CHECK(behind.columns % 2 == 0);
}

// Frames whose tiles make one list. What tiles compute is tested in direct_test.cpp.

namespace {

/// With a ReLU.
constexpr frame_convolution relu_step(shape in, extent2d kernel, std::size_t filters) {
    return support::with_relu(support::step(in, kernel, filters, in.channels));
}

/// How many outputs of some frames together have other bits than alone; `EndsWithinFrame` is whether a band
/// of tiles is to do so. NaN lies around all that they may read or write, between the frames too.
template <frame_convolution C, extent2d Tile, std::size_t Frames, bool EndsWithinFrame = false>
std::size_t other_bits(std::uint64_t seed) {
    using together = winograd_tiles<C, Tile, Frames>;
    using alone = winograd_tiles<C, Tile>;
    using method = winograd_method<C, Tile>;
    static_assert(together::block_vectors == alone::block_vectors);
    static_assert(!EndsWithinFrame ||
                  (together::band < together::count && together::tiles_per_frame % together::band != 0));
    constexpr std::size_t inputs = C.window.input.area() * C.input_stride, gap = 16 * lanes<float>,
                          outputs = C.output_rows() * C.output_columns() * C.output_stride(),
                          input_distance = inputs + gap, output_distance = outputs + 2 * gap;
    std::uint64_t state = seed;
    support::guarded_map input(Frames * input_distance, NAN, NAN);
    for (std::size_t frame = 0; frame < Frames; ++frame)
        for (std::size_t i = 0; i < inputs; ++i)
            input.data()[frame * input_distance + i] = support::draw(state);
    std::vector<float> biases(C.filters);
    for (std::size_t f = 0; f < C.filters; ++f)
        biases[f] = 0.125f * static_cast<float>(f) - 1;
    aligned_vector<float> packed(method::packed_elements);
    const auto weight = [](std::size_t f, std::size_t channel, std::size_t row, std::size_t column) {
        return static_cast<float>(std::sin(static_cast<double>(f * 31 + channel * 11 + row * 3 + column)));
    };
    method::pack(weight, biases.data(), packed.data());

    support::guarded_map found(Frames * output_distance, 1, NAN), expected(Frames * output_distance, 1, NAN);
    for (std::size_t frame = 0; frame < Frames && C.accumulates; ++frame)
        for (std::size_t i = 0; i < outputs; ++i)
            found.data()[frame * output_distance + i] = expected.data()[frame * output_distance + i] =
                support::draw(state);
    support::guarded_map workspace(together::workspace, 2, NAN);
    method::template run_list<Frames>(packed.data(), input.data(), input_distance, found.data(),
                                      output_distance, workspace.data());
    CHECK(workspace.untouched());
    CHECK(found.untouched());
    aligned_vector<float> own(method::workspace_elements);
    for (std::size_t frame = 0; frame < Frames; ++frame)
        method::run(packed.data(), input.data() + frame * input_distance,
                    expected.data() + frame * output_distance, own.data());
    std::size_t other = 0;
    for (std::size_t i = 0; i < Frames * output_distance; ++i)
        other +=
            std::bit_cast<std::uint32_t>(found.data()[i]) != std::bit_cast<std::uint32_t>(expected.data()[i]);
    return other;
}

} // namespace

TEST_CASE("winograd_method: frames together have the bits of each alone") {
    CHECK(other_bits<pooled(relu_step({4, 7, 16}, 2, 32), 2), extent2d(2), 4>(1) == 0); // few tiles a frame
    CHECK(other_bits<pooled(relu_step({5, 9, 16}, 3, 32), 2), extent2d(2), 3>(2) == 0);
    CHECK(other_bits<pooled(relu_step({3, 3, 64}, 3, 64), 2), extent2d(4), 4>(3) == 0); // one tile a frame
    CHECK(other_bits<adding(relu_step({6, 9, 16}, 3, 48), true), extent2d(2, 4), 2>(4) == 0);
    CHECK(other_bits<relu_step({14, 25, 16}, 3, 16), extent2d(3), 3, true>(5) == 0);
    // 32 tiles of 32 channels, whose elements would lie whole pages apart.
    CHECK(other_bits<relu_step({16, 32, 32}, 3, 32), extent2d(4), 2>(6) == 0);
}

TEST_CASE("winograd_method: layer-wise batching only where the transformed map stays in cache") {
    constexpr frame_convolution few = pooled(relu_step({4, 7, 16}, 2, 32), 2),
                                many = relu_step({10, 18, 64}, 3, 64);
    CHECK(winograd_method<few, extent2d(2)>::frames_together == 4);
    CHECK(winograd_method<many, extent2d(2)>::frames_together == 1);
    static_assert(winograd_tiles<few, extent2d(2), 4>::workspace * sizeof(float) <= l2_cache_bytes / 8);
}
