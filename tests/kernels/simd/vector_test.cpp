#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/runtime/random.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <support/tolerance.hpp>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

template <class T>
struct alignas(64) values : std::array<T, lanes<T>> {};

template <class T>
values<T> draw_values(std::uint32_t item) {
    random_stream random(1, random_purposes::order, item);
    values<T> v;
    for (T& each : v)
        each = static_cast<T>(random.uniform(-4, 4));
    return v;
}
template <class T>
values<T> stored(const vector<T>& v) {
    values<T> to;
    store(to.data(), v);
    return to;
}

} // namespace

TEST_CASE_TEMPLATE("vector: every operation, lane by lane", T, float, double) {
    const values<T> a = draw_values<T>(1), b = draw_values<T>(2), c = draw_values<T>(3);
    const vector<T> x = load(a.data()), y = load(b.data()), z = load(c.data());
    const values<T> sum = stored<T>(x + y), difference = stored<T>(x - y), product = stored<T>(x * y),
                    quotient = stored<T>(x / y), joined = stored<T>(multiply_add<T>(x, y, z)),
                    larger = stored<T>(maximum_keeping_nan<T>(x, y)), root = stored<T>(square_root<T>(x * x)),
                    chosen = stored<T>(choose<T>(x < y, x, z)), greater = stored<T>(choose<T>(x > y, x, z)),
                    same = stored<T>(choose<T>(x == x, x, z)), all = stored<T>(vector<T>(T{3}));
    vector<T> added = x;
    added += y;
    for (std::size_t i = 0; i < lanes<T>; ++i) {
        CHECK(stored(x)[i] == a[i]);
        CHECK(sum[i] == a[i] + b[i]);
        CHECK(stored(added)[i] == a[i] + b[i]);
        CHECK(difference[i] == a[i] - b[i]);
        CHECK(product[i] == a[i] * b[i]);
        CHECK(quotient[i] == a[i] / b[i]);
        // Fused or not: one rounding or two.
        const double exact =
            static_cast<double>(a[i]) * static_cast<double>(b[i]) + static_cast<double>(c[i]);
        const double size = std::abs(static_cast<double>(a[i] * b[i])) + std::abs(static_cast<double>(c[i]));
        CHECK(support::within(static_cast<double>(joined[i]),
                              {exact, support::accumulated(2 * support::unit_roundoff<T>, 2) * size}));
        CHECK(larger[i] == std::max(a[i], b[i]));
        CHECK(root[i] == std::sqrt(a[i] * a[i]));
        CHECK(chosen[i] == (a[i] < b[i] ? a[i] : c[i]));
        CHECK(greater[i] == (a[i] > b[i] ? a[i] : c[i]));
        CHECK(same[i] == a[i]);
        CHECK(all[i] == 3);
    }
}

TEST_CASE_TEMPLATE("sums_across_lanes: element i is the sum of row i", T, float, double) {
    // Powers of two that differ in every element: any exchange shows, and no sum is rounded.
    std::array<vector<T>, lanes<T>> rows;
    values<T> expected;
    for (std::size_t i = 0; i < lanes<T>; ++i) {
        values<T> row;
        expected[i] = 0;
        for (std::size_t j = 0; j < lanes<T>; ++j) {
            row[j] = static_cast<T>(i * lanes<T> + j + (i == j ? 1000 : 0));
            expected[i] += row[j];
        }
        rows[i] = load(row.data());
    }
    const values<T> sums = stored<T>(sums_across_lanes<T>(rows));
    for (std::size_t i = 0; i < lanes<T>; ++i)
        CHECK(sums[i] == expected[i]);
}

TEST_CASE_TEMPLATE("maximum: keeps a NaN from either side", T, float, double) {
    const vector<T> broken(std::numeric_limits<T>::quiet_NaN()), whole(T{1});
    for (std::size_t i = 0; i < lanes<T>; ++i) {
        CHECK(std::isnan(stored<T>(maximum_keeping_nan<T>(broken, whole))[i]));
        CHECK(std::isnan(stored<T>(maximum_keeping_nan<T>(whole, broken))[i]));
        CHECK(stored<T>(maximum_keeping_nan<T>(vector<T>(-std::numeric_limits<T>::infinity()), whole))[i] ==
              1);
    }
}

TEST_CASE("padded_size: up to whole vectors") {
    CHECK(padded_size<float>(0) == 0);
    CHECK(padded_size<float>(1) == lanes<float>);
    CHECK(padded_size<float>(lanes<float>) == lanes<float>);
    CHECK(padded_size<float>(lanes<float> + 1) == 2 * lanes<float>);
}
