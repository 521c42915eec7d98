#include <tactnet/deployment/steps/elementwise.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>

using namespace tactnet;

TEST_CASE("activation_step: of a ReLU negative numbers are zero, and nothing is written behind the map") {
    using step = activation_step<single_precision, relu_function, shape{1, 2, 3}, 4>;
    alignas(64) std::array<float, 12> in{-1, 2, -3, 0, 4, -5, 6, 0, 7, 7, 7, 7}, out{};
    out.fill(-9);
    step::run(nullptr, in.data(), out.data(), nullptr);
    const std::array<float, 12> expected{0, 2, 0, 0, 4, 0, 6, 0, -9, -9, -9, -9};
    CHECK(out == expected);
}

namespace {

struct one_more {
    static constexpr const char *name = "one_more", *title = "One more", *type = "one_more", *header = "";
    static constexpr bool moves_zero = true;
    template <class T>
    static constexpr T value(T x) {
        return x + 1;
    }
    template <class T>
    static constexpr T backward(T, T gradient) {
        return gradient;
    }
};

} // namespace

TEST_CASE("activation_step: a function that moves zero leaves zeros after the last channel") {
    using step = activation_step<single_precision, one_more, shape{1, 2, 3}, 4>;
    alignas(64) std::array<float, 8> in{-1, 2, -3, 0, 4, -5, 6, 0}, out{};
    step::run(nullptr, in.data(), out.data(), nullptr);
    CHECK(out == std::array<float, 8>{0, 3, -2, 0, 5, -4, 7, 0});
    CHECK(step::output_bound(nullptr, 7) == 8);
}
