#include <tactnet/deployment/steps/elementwise.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>

using namespace tactnet;

TEST_CASE("relu_step: negative numbers are zero, and nothing is written behind the map") {
    using step = relu_step<single_precision, shape{1, 2, 3}, 4>;
    alignas(64) std::array<float, 12> in{-1, 2, -3, 0, 4, -5, 6, 0, 7, 7, 7, 7}, out{};
    out.fill(-9);
    step::run(nullptr, in.data(), out.data(), nullptr);
    const std::array<float, 12> expected{0, 2, 0, 0, 4, 0, 6, 0, -9, -9, -9, -9};
    CHECK(out == expected);
}
