#include <tactnet/kernels/frame/winograd_tiles.hpp>
#include <tactnet/kernels/integer/convolution/winograd_tiles.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

/// The most lines of elements in a set of a cache of 64 sets, if each element has a line `distance` bytes
/// after that of the element before.
constexpr std::size_t most_in_a_set(std::size_t elements, std::size_t distance) {
    std::array<std::size_t, 64> lines{};
    for (std::size_t e = 0; e < elements; ++e)
        ++lines[e * distance / cache_line % lines.size()];
    return *std::max_element(lines.begin(), lines.end());
}
/// As most_in_a_set, for the elements of a tile: each has so many numbers of type T.
template <class T>
constexpr std::size_t most_of_tiles(std::size_t elements, std::size_t numbers) {
    return most_in_a_set(elements, tile_distance<T>(numbers, elements) * sizeof(T));
}

} // namespace

TEST_CASE("tile_distance: the elements of a tile do not crowd into few sets of the first level of cache") {
    constexpr std::size_t ways = std::max<std::size_t>(l1_cache_bytes / cache_line / 64, 1);
    // 32 tiles of 32 channels lie 4096 bytes apart, and 36 lines of one set would evict each other.
    REQUIRE(most_in_a_set(36, 32 * 32 * sizeof(float)) == 36);
    for (std::size_t numbers = 16; numbers <= 8192; numbers += 16)
        for (const std::size_t elements : {9U, 16U, 24U, 30U, 36U}) {
            CHECK(tile_distance<float>(numbers, elements) >= numbers);
            CHECK(most_of_tiles<float>(elements, numbers) <= std::max<std::size_t>(ways, 1));
        }
}

TEST_CASE("tile_distance: where a line of each element has its place, tiles stay close") {
    CHECK(tile_distance<float>(8 * 12, 36) == 8 * 12);
    CHECK(tile_distance<std::int16_t>(6 * 128, 30) == 6 * 128);
}

TEST_CASE("best_tile: the slower weights come, the fewer a layer packs") {
    constexpr frame_convolution c{
        .window = {{6, 12, 64}, 3, 1, 1, 1, 1, 1}, .filters = 64, .input_stride = 64};
    if (best_tile(c, 28) == extent2d(0))
        return; // vectors without tiles
    std::size_t last = 36;
    for (const std::size_t bytes_per_cycle : {1000U, 28U, 14U, 9U, 4U, 1U}) {
        CAPTURE(bytes_per_cycle);
        const std::size_t elements = tile_side(c, best_tile(c, bytes_per_cycle)).area();
        CHECK(elements <= last);
        last = elements;
    }
    CHECK(last == 16); // 2 × 2, the fewest
}
