// Memory for vectors: on cache lines, and large blocks on large pages.

#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>

using namespace tactnet;

namespace {

std::uintptr_t place_of(const void* memory) {
    return reinterpret_cast<std::uintptr_t>(memory);
}

} // namespace

TEST_CASE("aligned: blocks begin on a cache line, those of two large pages or more on one of these") {
    for (const std::size_t bytes : {std::size_t{1}, std::size_t{100}, detail::least_on_large_pages - 1,
                                    detail::least_on_large_pages, 3 * detail::large_page + 5}) {
        CAPTURE(bytes);
        aligned_allocator<std::byte> memory;
        std::byte* const block = memory.allocate(bytes);
        CHECK(place_of(block) %
                  (bytes < detail::least_on_large_pages ? vector_alignment : detail::large_page) ==
              0);
        block[0] = block[bytes - 1] = std::byte{7};
        CHECK(block[0] == block[bytes - 1]);
        memory.deallocate(block, bytes);
    }
}

TEST_CASE("aligned: what no size holds is refused") {
    aligned_allocator<double> memory;
    CHECK_THROWS_AS((void)memory.allocate(std::numeric_limits<std::size_t>::max() / 8),
                    std::bad_array_new_length);
}

#if defined(__linux__)
TEST_CASE(
    "aligned: pages next to a block are left alone where none is whole, and a refusal changes nothing") {
    aligned_allocator<float> memory;
    float* const block = memory.allocate(16);
    block[0] = 3;
    detail::prefer_large_pages(block, 64);                             // no whole page
    detail::prefer_large_pages(nullptr, detail::least_on_large_pages); // which the system refuses
    CHECK(block[0] == 3);
    memory.deallocate(block, 16);
}
#endif
