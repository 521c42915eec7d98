#include <tactnet/deployment/steps/elementwise.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace tactnet;

TEST_CASE("softmax_step: over the channels of each pixel, zero between them, nothing behind the last") {
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
