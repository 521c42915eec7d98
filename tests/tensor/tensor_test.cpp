#include <tactnet/tensor/aligned.hpp>
#include <tactnet/tensor/batch.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <numeric>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

using namespace tactnet;

// Memory for vectors: on cache lines, and large blocks on large pages.

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

TEST_CASE("aligned: weights fill large pages from 256 KiB on") {
    for (const std::size_t bytes : {detail::least_weights_on_large_pages - 1,
                                    detail::least_weights_on_large_pages, detail::large_page + 5}) {
        CAPTURE(bytes);
        detail::weight_vector<std::byte> weights(bytes);
        const bool large = bytes >= detail::least_weights_on_large_pages;
        CHECK(place_of(weights.data()) % (large ? detail::large_page : vector_alignment) == 0);
        weights = detail::weight_vector<std::byte>(bytes, std::byte{7});
        CHECK(weights.back() == std::byte{7});
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

// Usable in constants, zero to begin with, ordered [channel][row][column].
constexpr float element_of_a_constant() {
    tensor<float, shape{2, 3, 4}> t;
    t(1, 2, 3) = 5;
    return t.data()[(3 * 2 + 1) * 3 + 2] + t(0, 0);
}
static_assert(element_of_a_constant() == 5);
static_assert(tensor<float, shape{2, 3, 4}>::size() == 24);
static_assert(std::is_trivially_copyable_v<tensor<float, shape{2, 3}>>);
static_assert(alignof(tensor<std::uint8_t, shape{1, 1}>) == vector_alignment);
// A view of constants can be made of a view, but not the other way round.
static_assert(std::is_convertible_v<tensor_view<float, shape{2, 2}>, tensor_view<const float, shape{2, 2}>>);
static_assert(
    !std::is_constructible_v<tensor_view<float, shape{2, 2}>, tensor_view<const float, shape{2, 2}>>);
static_assert(!std::is_convertible_v<const tensor<float, shape{2, 2}>&, tensor_view<float, shape{2, 2}>>);

TEST_CASE("tensor: elements by row, column and channel are those in memory") {
    tensor<int, shape{3, 4, 2}> t;
    std::iota(t.begin(), t.end(), 0);
    int expected = 0;
    for (std::size_t channel = 0; channel < 2; ++channel)
        for (std::size_t row = 0; row < 3; ++row)
            for (std::size_t column = 0; column < 4; ++column)
                CHECK(t(row, column, channel) == expected++);
    CHECK(reinterpret_cast<std::uintptr_t>(t.data()) % vector_alignment == 0);
}

TEST_CASE("tensor_view: refers to memory of the caller") {
    std::vector<int> memory(6);
    const tensor_view<int, shape{2, 3}> view(memory.data());
    view(1, 2) = 7;
    CHECK(memory[5] == 7);
    const tensor_view<const int, shape{2, 3}> constant = view;
    CHECK(constant(1, 2) == 7);
    CHECK(constant.data() == memory.data());
    CHECK(constant.elements().size() == 6);
    tensor<int, shape{2, 3}> copy;
    const tensor_view<int, shape{2, 3}> of_copy = copy;
    of_copy(0, 0) = 3;
    CHECK(copy(0, 0) == 3);
}

TEST_CASE("try_view: elements whose number is known at run time, if there are as many as the shape has") {
    std::vector<float> elements{0, 1, 2, 3, 4, 5};
    const auto view = try_view<shape{2, 3}>(elements);
    static_assert(std::is_same_v<decltype(view), const std::optional<tensor_view<float, shape{2, 3}>>>);
    REQUIRE(view);
    CHECK((*view)(1, 2) == 5);
    CHECK(view->data() == elements.data());
    CHECK(!try_view<shape{3, 3}>(elements));
    const std::vector<float>& constant = elements;
    CHECK(try_view<shape{3, 2}>(constant)->data() == elements.data());
    CHECK(try_view<shape{1, 2}>(std::span<const float>(elements).subspan(1, 2))->data() ==
          elements.data() + 1);
    CHECK(!try_view<shape{2, 3}>(std::span<const float>()));
}

namespace {
constexpr shape size{2, 3, 2};
using images = batch<float, size, 4>;
} // namespace

static_assert(images::view_type::lane_block_size == 48);
static_assert(std::is_convertible_v<images::view_type, images::const_view_type>);
static_assert(!std::is_constructible_v<images::view_type, images::const_view_type>);

TEST_CASE("batch: samples lie side by side in lane blocks") {
    images b(6);
    CHECK(b.samples() == 6);
    CHECK(b.view().lane_blocks() == 2);
    CHECK(b.view().samples_in(0) == 4);
    CHECK(b.view().samples_in(1) == 2);
    for (std::size_t s = 0; s < 6; ++s)
        for (std::size_t e = 0; e < size.size(); ++e)
            b(s, e) = static_cast<float>(100 * s + e);
    const float* memory = b.view().data();
    CHECK(reinterpret_cast<std::uintptr_t>(memory) % vector_alignment == 0);
    for (std::size_t s = 0; s < 6; ++s)
        for (std::size_t e = 0; e < size.size(); ++e)
            CHECK(memory[s / 4 * 48 + e * 4 + s % 4] == static_cast<float>(100 * s + e));
    CHECK(b.view().lane_block(1) == memory + 48);
    for (std::size_t e = 0; e < size.size(); ++e) // lanes past the last sample
        for (std::size_t lane = 2; lane < 4; ++lane)
            CHECK(b.view().lane_block(1)[e * 4 + lane] == 0);
}

TEST_CASE("batch: whole samples in and out") {
    images b(5);
    tensor<float, size> in, out;
    for (std::size_t e = 0; e < size.size(); ++e)
        in.data()[e] = static_cast<float>(e + 1);
    b.set(4, in);
    b.get(4, out);
    CHECK(std::equal(in.begin(), in.end(), out.begin()));
    b.get(3, out);
    CHECK(out(1, 2, 1) == 0);
}

TEST_CASE("batch: all zero after every resize, also when it shrinks and grows again") {
    images b(5);
    for (const std::size_t samples : {5u, 1u, 0u, 8u, 9u}) {
        b.resize(samples);
        CHECK(b.samples() == samples);
        CHECK(b.view().lane_blocks() == (samples + 3) / 4);
        bool zero = true;
        for (std::size_t i = 0; i < b.view().lane_blocks() * 48; ++i) {
            zero = zero && b.view().data()[i] == 0;
            b.view().data()[i] = 9;
        }
        CHECK(zero);
    }
}

TEST_CASE("batch: parts are whole lane blocks, the last one with the samples that are left") {
    images b(9);
    b(4, 7) = 3, b(8, 1) = 4;
    const auto middle = b.view().part(1, 2), rest = b.view().part(1, 3);
    CHECK(middle.samples() == 4);
    CHECK(middle(0, 7) == 3);
    CHECK(rest.samples() == 5);
    CHECK(rest.samples_in(1) == 1);
    CHECK(rest(4, 1) == 4);
    const images::view_type nothing(nullptr, 9);
    CHECK(nothing.part(1, 2).data() == nullptr);
    CHECK(nothing.part(2, 3).samples() == 1);
}
