#include <tactnet/simulation/jpeg_storage.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace {

using namespace tactnet::simulation;

template <tactnet::shape Shape>
tactnet::tensor<float, Shape> imprint() {
    tactnet::tensor<float, Shape> counts;
    for (std::size_t row = 0; row < Shape.rows; ++row)
        for (std::size_t column = 0; column < Shape.columns; ++column) {
            const double y = static_cast<double>(row) - 6.3, x = static_cast<double>(column) - 9.1;
            counts(row, column) =
                static_cast<float>(std::floor(std::max(0.0, 255 - 9 * (x * x + 0.5 * y * y))));
        }
    return counts;
}

template <tactnet::shape Shape>
tactnet::tensor<float, Shape> stored(tactnet::tensor<float, Shape> counts, int quality) {
    jpeg_storage::bound<Shape>(jpeg_storage{quality}, {}).apply(counts.view(), {});
    return counts;
}

// The definition in double precision, sums over all 64 terms (T.81, A.3.3), of the table's first entries for
// quality 50.
double coefficient(const std::array<std::array<double, 8>, 8>& s, int v, int u) {
    double sum = 0;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            sum += (s[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] - 128) *
                   std::cos((2 * x + 1) * u * std::numbers::pi / 16) *
                   std::cos((2 * y + 1) * v * std::numbers::pi / 16);
    return sum / 4 * (u == 0 ? std::sqrt(0.5) : 1) * (v == 0 ? std::sqrt(0.5) : 1);
}

TEST_CASE("no file changes no bit") {
    constexpr tactnet::shape size{13, 21};
    const auto counts = imprint<size>();
    CHECK(std::ranges::equal(stored(counts, 0), counts));
}

/// Between 60 and 200: no rounding by a file leaves the range of counts.
template <tactnet::shape Shape>
tactnet::tensor<float, Shape> grey() {
    auto counts = imprint<Shape>();
    for (float& count : counts)
        count = std::floor(60 + count * 140 / 255);
    return counts;
}

TEST_CASE("what a file holds is stored again almost as it is") {
    constexpr tactnet::shape size{28, 50};
    const auto once = stored(grey<size>(), 75), twice = stored(once, 75);
    for (std::size_t i = 0; i < size.size(); ++i)
        CHECK(std::abs(once.data()[i] - twice.data()[i]) <= 1);
    CHECK(!std::ranges::equal(once, grey<size>()));
}

TEST_CASE("a block keeps the nearest multiples of the table's steps") {
    constexpr tactnet::shape size{8, 8};
    auto counts = grey<size>();
    counts(0, 0) = 190, counts(7, 7) = 90;
    const auto kept = stored(counts, 50);
    std::array<std::array<double, 8>, 8> before{}, after{};
    for (std::size_t i = 0; i < 64; ++i) {
        before[i / 8][i % 8] = static_cast<double>(counts.data()[i]);
        after[i / 8][i % 8] = static_cast<double>(kept.data()[i]);
    }
    // Of table K.1: the corners tell the order of its rows and columns.
    struct entry {
        int v, u;
        double step;
    };
    for (const entry e : {entry{0, 0, 16}, entry{0, 1, 11}, entry{1, 0, 12}, entry{0, 7, 61}, entry{7, 0, 72},
                          entry{7, 7, 99}, entry{2, 5, 57}}) {
        CAPTURE(e.v);
        CAPTURE(e.u);
        const double asked = std::nearbyint(coefficient(before, e.v, e.u) / e.step) * e.step;
        // Counts are rounded by up to a half each, and clamped: a coefficient moves by at most 64 × ½ / 8
        // × 2.
        CHECK(std::abs(coefficient(after, e.v, e.u) - asked) < std::min(8.0, 0.45 * e.step));
    }
}

TEST_CASE("images of any size, with faint counts around an imprint") {
    constexpr tactnet::shape size{28, 50};
    const auto counts = imprint<size>(), kept = stored(counts, 75);
    double error = 0;
    for (std::size_t i = 0; i < size.size(); ++i) {
        CHECK((kept.data()[i] >= 0 && kept.data()[i] <= 255 && kept.data()[i] == std::floor(kept.data()[i])));
        error += static_cast<double>(std::abs(kept.data()[i] - counts.data()[i]));
    }
    CHECK(error / static_cast<double>(size.size()) < 2);
    const auto faint = [](const auto& image) {
        return std::ranges::count_if(image, [](float count) { return count > 0 && count < 8; });
    };
    CHECK(faint(kept) > faint(counts) + 20);
    CHECK(kept(27, 49) == 0);

    constexpr tactnet::shape one{1, 1};
    tactnet::tensor<float, one> dot;
    dot(0, 0) = 77;
    CHECK(std::abs(stored(dot, 75)(0, 0) - 77) <= 1);
}

} // namespace
