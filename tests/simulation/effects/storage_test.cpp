#include <tactnet/image/resize.hpp>
#include <tactnet/simulation/effects/storage.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <ratio>
#include <simulation/effect_frames.hpp>

namespace {

using namespace tactnet;
using simulation::jpeg_storage;
using simulation::resolution;

constexpr shape size{28, 50};
using block = std::array<double, 64>;

/// The cosine transform of eight by eight pixels as the standard defines it (ITU-T T.81, A.3.3), or back.
block transformed(const block& from, bool back) {
    const auto basis = [](std::size_t frequency, std::size_t pixel) {
        return (frequency == 0 ? std::sqrt(0.125) : 0.5) *
               std::cos((2 * static_cast<double>(pixel) + 1) * static_cast<double>(frequency) *
                        std::numbers::pi / 16);
    };
    block to{};
    for (std::size_t a = 0; a < 64; ++a)
        for (std::size_t b = 0; b < 64; ++b)
            to[a] += from[b] * (back ? basis(b / 8, a / 8) * basis(b % 8, a % 8)
                                     : basis(a / 8, b / 8) * basis(a % 8, b % 8));
    return to;
}

// libjpeg's whole numbers err by some hundredths of a count, which counts where a frequency lies that near to
// the middle between two levels: then it may take the other one, and the block is another. Such blocks are
// left out.
TEST_CASE("jpeg_storage: as the standard's transform in double precision, within a count") {
    constexpr shape one{8, 8};
    const auto divisors = simulation::jpeg_divisors(75);
    std::size_t compared = 0;
    for (std::uint32_t sample = 0; sample < 200; ++sample) {
        auto counts = support::pressed<one>(sample, 255);
        block exact{};
        for (std::size_t i = 0; i < 64; ++i)
            exact[i] = static_cast<double>(counts.data()[i] = std::floor(counts.data()[i])) - 128;
        exact = transformed(exact, false);
        bool between = false;
        for (std::size_t i = 0; i < 64; ++i) {
            const double levels = exact[i] / divisors[i];
            between = between || std::abs(std::abs(levels - std::trunc(levels)) - 0.5) * divisors[i] < 0.2;
            exact[i] = std::round(levels) * divisors[i];
        }
        if (between)
            continue;
        ++compared;
        exact = transformed(exact, true);
        const auto stored = support::after<one>(jpeg_storage{75}, counts);
        for (std::size_t i = 0; i < 64; ++i)
            CHECK(std::abs(static_cast<double>(stored.data()[i]) - std::clamp(exact[i] + 128, 0.0, 255.0)) <=
                  1);
    }
    CHECK(compared > 20);
}

TEST_CASE("jpeg_storage: blocks beyond the edge repeat the last row and column") {
    constexpr shape cut{5, 11}, whole{8, 16};
    const auto counts = support::pressed<cut>(1, 255);
    support::frame<whole> repeated;
    for (std::size_t row = 0; row < whole.rows; ++row)
        for (std::size_t column = 0; column < whole.columns; ++column)
            repeated(row, column) = counts(std::min(row, cut.rows - 1), std::min(column, cut.columns - 1));
    const auto stored = support::after<cut>(jpeg_storage{}, counts);
    const auto expected = support::after<whole>(jpeg_storage{}, repeated);
    for (std::size_t row = 0; row < cut.rows; ++row)
        for (std::size_t column = 0; column < cut.columns; ++column)
            CHECK(stored(row, column) == expected(row, column));
}

TEST_CASE("jpeg_storage: leaves small counts around an imprint, and nothing where there is nothing") {
    auto counts = support::filled<size>(0);
    counts(10, 20) = 200;
    const auto stored = support::after<size>(jpeg_storage{}, counts);
    std::size_t around = 0;
    for (std::size_t row = 0; row < size.rows; ++row)
        for (std::size_t column = 0; column < size.columns; ++column) {
            const bool same_block = row / 8 == 10 / 8 && column / 8 == 20 / 8;
            if (!same_block)
                CHECK(stored(row, column) == 0);
            around += same_block && stored(row, column) > 0;
        }
    CHECK(around > 5);
}

TEST_CASE("jpeg_storage: whole counts 0 to 255 come out whatever comes in") {
    CHECK(simulation::jpeg_divisors(101) == simulation::jpeg_divisors(100));
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                infinity = std::numeric_limits<float>::infinity();
    for (const float value : {nan, infinity, -infinity, -7.0f, 1e30f, 0.4f, 254.6f}) {
        auto counts = support::pressed<size>(0, 255);
        counts(3, 3) = value;
        for (const float count : support::after<size>(jpeg_storage{}, counts))
            CHECK((count >= 0 && count <= 255 && count == std::floor(count)));
    }
}

constexpr shape full{28, 50}, half{14, 25};
static_assert(simulation::output_shape<resolution<14, 25>, full>() == half);

TEST_CASE("resolution: whole counts, as the resized image stored in bytes") {
    const auto counts = support::pressed<full>(0, 255);
    tensor<std::uint8_t, half> expected;
    resize<full, half>(counts.view(), expected.view());
    support::frame<half> resized;
    const resolution<14, 25>::bound<full> bound({}, {});
    bound.apply(counts.view(), resized.view(), {});
    for (std::size_t i = 0; i < half.size(); ++i)
        CHECK(resized.data()[i] == static_cast<float>(expected.data()[i]));
}

TEST_CASE("resolution: no overshoot beyond the counts") {
    auto counts = support::filled<full>(0);
    for (std::size_t i = 0; i < full.size(); ++i)
        counts.data()[i] = i / full.columns < 14 ? 14.0f : 0.0f;
    support::frame<shape{56, 100}> resized;
    const resolution<56, 100, keys_cubic<std::ratio<-1, 2>, false>>::bound<full> bound({.last = 14}, {});
    bound.apply(counts.view(), resized.view(), {});
    for (const float count : resized)
        CHECK((count >= 0 && count <= 14 && count == std::floor(count)));
}

} // namespace
