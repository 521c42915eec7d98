#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/kernels/rows/working_set.hpp>
#include <tactnet/runtime/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <support/tolerance.hpp>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A working set of random numbers, some samples of which may not rise or fall.
struct working_set {
    std::size_t count = 5 * lanes<double>;
    aligned_vector<double> gradient, up, low, diagonal;
    aligned_vector<float> rising, falling;

    explicit working_set(std::uint64_t seed) {
        random_stream random(seed, random_purposes::order);
        for (std::size_t i = 0; i < count; ++i) {
            gradient.push_back(std::floor(random.uniform(-8, 8))); // with ties
            up.push_back(random.below(3) == 0 ? -infinity : 0);
            low.push_back(random.below(3) == 0 ? infinity : 0);
            diagonal.push_back(random.uniform(1, 2));
            rising.push_back(static_cast<float>(random.uniform(-1, 1)));
            falling.push_back(static_cast<float>(random.uniform(-1, 1)));
        }
    }
    [[nodiscard]] selected_sample first_highest() const {
        selected_sample best{-infinity, 0};
        for (std::size_t i = 0; i < count; ++i)
            if (gradient[i] + up[i] > best.value)
                best = {gradient[i] + up[i], i};
        return best;
    }
};

} // namespace

TEST_CASE("working_set: choices and steps as plain loops make them") {
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        working_set w(seed);
        const selected_sample expected = w.first_highest();
        const selected_sample highest = steepest(w.gradient.data(), w.up.data(), w.count);
        CHECK(highest.index == expected.index);
        CHECK(highest.value == expected.value);

        const double own = 1.5, least = 1e-12;
        const selected_partner partner =
            select_partner(w.gradient.data(), w.low.data(), w.rising.data(), w.diagonal.data(), own,
                           highest.value, least, w.count);
        double lowest = infinity, gain = -1;
        const auto gain_of = [&](std::size_t i) {
            const double b = highest.value - (w.gradient[i] + w.low[i]);
            const double a = own + w.diagonal[i] - 2 * static_cast<double>(w.rising[i]);
            return b > 0 ? b * b / std::max(a, least) : -1;
        };
        for (std::size_t i = 0; i < w.count; ++i) {
            lowest = std::min(lowest, w.gradient[i] + w.low[i]);
            gain = std::max(gain, gain_of(i));
        }
        CHECK(partner.lowest == lowest);
        // The sum under the fraction may be rounded once more or less.
        CHECK(partner.sample.value == doctest::Approx(gain).epsilon(1e-12));
        CHECK(gain_of(partner.sample.index) == doctest::Approx(gain).epsilon(1e-12));

        const aligned_vector<double> before = w.gradient;
        const selected_sample next =
            update_gradient(w.gradient.data(), w.rising.data(), w.falling.data(), 0.25, w.up.data(), w.count);
        bool moved = true;
        for (std::size_t i = 0; i < w.count; ++i) {
            const double exact =
                before[i] - 0.25 * (static_cast<double>(w.rising[i]) - static_cast<double>(w.falling[i]));
            moved = moved && w.gradient[i] == doctest::Approx(exact).epsilon(1e-14);
        }
        CHECK(moved);
        CHECK(next.index == w.first_highest().index);
    }
}

TEST_CASE("working_set: dense rows: a long product and a sum, against double precision") {
    random_stream random(1, random_purposes::order);
    for (const std::size_t count : {std::size_t{16}, std::size_t{1408}, std::size_t{16 * 1001}}) {
        aligned_vector<float> a(count), b(count);
        double exact = 0, size = 0;
        for (std::size_t i = 0; i < count; ++i) {
            a[i] = static_cast<float>(random.uniform(-1, 1));
            b[i] = static_cast<float>(random.uniform(-1, 1));
            exact += static_cast<double>(a[i]) * static_cast<double>(b[i]);
            size += std::abs(static_cast<double>(a[i]) * static_cast<double>(b[i]));
        }
        // A run holds up to 64 products in a chain, those left over after it 3 more, and 4 chains.
        const double error = support::accumulated(support::unit_roundoff<float>, 64 + 3 + 2 + 1) * size;
        CHECK(support::within(dot(a.data(), b.data(), count), {exact, error}));

        aligned_vector<float> sum = b;
        add_multiple(sum.data(), -3, a.data(), count);
        bool right = true;
        for (std::size_t i = 0; i < count; ++i)
            right = right && sum[i] == doctest::Approx(b[i] - 3 * a[i]).epsilon(1e-5);
        CHECK(right);
    }
}

TEST_CASE("weighted: sums of rows in double, whole numbers exactly") {
    constexpr std::size_t width = 3 * lanes<double>, rows = 7;
    aligned_vector<double> values(rows * width), sums(width, 99);
    std::array<float, rows> weights{};
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<double>(i % 11) - 5;
    for (std::size_t r = 0; r < rows; ++r)
        weights[r] = static_cast<float>(r) - 2;
    weighted_row_sums(weights.data(), values.data(), rows, width, sums.data());
    for (std::size_t c = 0; c < width; ++c) {
        double expected = 0;
        for (std::size_t r = 0; r < rows; ++r)
            expected += static_cast<double>(weights[r]) * values[r * width + c];
        CHECK(sums[c] == expected);
    }
}
