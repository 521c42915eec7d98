#include <tactnet/deployment/steps/elementwise.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <ratio>

using namespace tactnet;

TEST_CASE("activation_step: ReLU makes negative numbers zero, and nothing is written past the map") {
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
static_assert(activation_function<one_more>);

} // namespace

TEST_CASE("activation_step: a function that moves zero leaves zeros after the last channel") {
    using step = activation_step<single_precision, one_more, shape{1, 2, 3}, 4>;
    alignas(64) std::array<float, 8> in{-1, 2, -3, 0, 4, -5, 6, 0}, out{};
    step::run(nullptr, in.data(), out.data(), nullptr);
    CHECK(out == std::array<float, 8>{0, 3, -2, 0, 5, -4, 7, 0});
    CHECK(step::output_bound(nullptr, 7) == 8);
}

namespace {

constexpr shape map{2, 2, 8};

template <class Rule>
double reach_of(double input) {
    return local_response_norm_step<single_precision, map, 8, Rule>::output_bound(nullptr, input);
}

} // namespace

TEST_CASE("local_response_norm_step::output_bound: the largest of x, of x by the smallest divisor, and of "
          "the squares") {
    using usual = kernels::response_rule<5, std::ratio<1, 10000>, std::ratio<3, 4>, std::ratio<2>>;
    CHECK(reach_of<usual>(0.1) == doctest::Approx(0.1));   // squares are small, and 2^-3/4 is below one
    CHECK(reach_of<usual>(3) == doctest::Approx(5 * 9.0)); // squares
    using amplifying = kernels::response_rule<5, std::ratio<1, 10000>, std::ratio<3, 4>, std::ratio<1, 16>>;
    CHECK(reach_of<amplifying>(0.5) == doctest::Approx(0.5 * std::pow(1.0 / 16, -0.75)));
}

TEST_CASE("softmax_step: over the channels of each pixel, zeros in the gaps, nothing past the last") {
    using step = softmax_step<single_precision, shape{1, 2, 2}, 4>;
    alignas(64) std::array<float, 12> in{0, 0, 7, 7, 1, 0, 7, 7, 9, 9, 9, 9}, out{};
    out.fill(-1);
    step::run(nullptr, in.data(), out.data(), nullptr);
    const double of_one = 1 / (1 + std::exp(-1.0));
    CHECK(out[0] == doctest::Approx(0.5));
    CHECK(out[1] == doctest::Approx(0.5));
    CHECK(out[4] == doctest::Approx(of_one));
    CHECK(out[5] == doctest::Approx(1 - of_one));
    for (const std::size_t between : {2u, 3u, 6u, 7u})
        CHECK(out[between] == 0);
    for (std::size_t behind = 8; behind < 12; ++behind)
        CHECK(out[behind] == -1);
}
