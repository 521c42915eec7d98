#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <numeric>
#include <type_traits>
#include <vector>

using namespace tactnet;

// Usable in constants, zero to begin with, ordered [channel][row][column].
constexpr float element_of_a_constant() {
    tensor<float, shape{2, 3, 4}> t;
    t(1, 2, 3) = 5;
    return t.data()[(3 * 2 + 1) * 3 + 2] + t(0, 0);
}
static_assert(element_of_a_constant() == 5);
static_assert(tensor<float, shape{2, 3, 4}>::size() == 24);
static_assert(std::is_trivially_copyable_v<tensor<float, shape{2, 3}>>);
static_assert(alignof(tensor<std::uint8_t, shape{1, 1}>) == alignment);
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
    CHECK(reinterpret_cast<std::uintptr_t>(t.data()) % alignment == 0);
}

TEST_CASE("tensor_view: looks at someone else's memory") {
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
