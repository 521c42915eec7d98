#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
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
