#include <tactnet/kernels/frame/winograd.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <support/guarded_map.hpp>
#include <vector>

// Frames whose tiles make one list. What tiles compute is tested in direct_test.cpp.

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

constexpr frame_convolution step(shape in, extent2d kernel, std::size_t filters, std::size_t input_stride) {
    return {.window = sliding_window::over(in, kernel, 1, padding::same),
            .filters = filters,
            .input_stride = input_stride,
            .relu = true};
}
constexpr frame_convolution pooled(frame_convolution c) {
    c.pool = 2;
    c.pooled_rows = (c.window.output_rows() + 1) / 2, c.pooled_columns = (c.window.output_columns() + 1) / 2;
    return c;
}
constexpr frame_convolution adding(frame_convolution c) {
    c.accumulates = true;
    return c;
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

TEST_SUITE("kernels") {
    TEST_CASE("winograd_method: frames together have the bits of each alone") {
        CHECK(other_bits<pooled(step({4, 7, 16}, 2, 32, 16)), extent2d(2), 4>(1) == 0); // few tiles a frame
        CHECK(other_bits<pooled(step({5, 9, 16}, 3, 32, 16)), extent2d(2), 3>(2) == 0);
        CHECK(other_bits<pooled(step({3, 3, 64}, 3, 64, 64)), extent2d(4), 4>(3) == 0); // one tile a frame
        CHECK(other_bits<adding(step({6, 9, 16}, 3, 48, 16)), extent2d(2, 4), 2>(4) == 0);
        CHECK(other_bits<step({14, 25, 16}, 3, 16, 16), extent2d(3), 3>(5) ==
              0); // bands that end within a frame
    }

    TEST_CASE("winograd_method: layer-wise batching only where the transformed map stays in cache") {
        constexpr frame_convolution few = pooled(step({4, 7, 16}, 2, 32, 16)),
                                    many = step({10, 18, 64}, 3, 64, 64);
        CHECK(winograd_method<few, extent2d(2)>::frames_together == 4);
        CHECK(winograd_method<many, extent2d(2)>::frames_together == 1);
        static_assert(winograd_tiles<few, extent2d(2), 4>::workspace * sizeof(float) <= l2_cache_bytes / 8);
    }
}
