#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/runtime/random.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <support/tolerance.hpp>

using namespace tactnet;
using namespace tactnet::kernels;
using support::accumulated;
using support::unit_roundoff;

namespace {

template <class T>
aligned_vector<T> draw_vectors(std::size_t count, double low, double high) {
    random_stream random(2, random_purposes::order);
    aligned_vector<T> v(count * lanes<T>);
    for (T& each : v)
        each = static_cast<T>(random.uniform(low, high));
    return v;
}

template <class T>
void check_moments(std::size_t count, std::size_t used, double low, double high) {
    CAPTURE(count);
    CAPTURE(used);
    aligned_vector<T> v = draw_vectors<T>(count, low, high);
    for (std::size_t i = 0; i < count; ++i) // what lies in unused lanes must not matter
        for (std::size_t lane = used; lane < lanes<T>; ++lane)
            v[i * lanes<T> + lane] = T{12345};
    long double sum = 0, squares = 0;
    const auto n = static_cast<long double>(count * used);
    const auto for_each = [&](auto&& body) {
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t lane = 0; lane < used; ++lane)
                body(static_cast<long double>(v[i * lanes<T> + lane]));
    };
    for_each([&](long double x) { sum += x; });
    const long double mean = sum / n;
    for_each([&](long double x) { squares += (x - mean) * (x - mean); });

    const moments found = moments_of(v.data(), count, used);
    CHECK(found.count == static_cast<double>(n));
    // Measured from the first value, so that the terms are at most the range; runs of 16 in the working
    // precision.
    const double range = high - low, terms = accumulated(unit_roundoff<T>, run_length + 3);
    const double last =
        unit_roundoff<double> * (std::abs(static_cast<double>(mean)) + range); // the mean itself is double
    CHECK(support::within(found.mean, {static_cast<double>(mean), terms * range + 2 * last}));
    CHECK(support::within(found.variance(),
                          {static_cast<double>(squares / n), 3 * terms * range * range + last * range}));
}

} // namespace

TEST_CASE_TEMPLATE("moments_of: against two passes in extended precision", T, float, double) {
    for (const std::size_t count : {1u, 2u, 15u, 16u, 17u, 91u, 1400u})
        for (const std::size_t used : {std::size_t{1}, (lanes<T> + 1) / 2, lanes<T>}) {
            check_moments<T>(count, used, -1, 1);
            check_moments<T>(count, used, 1e4 - 1e-2, 1e4 + 1e-2);
            check_moments<T>(count, used, -255, 0);
        }
}

TEST_CASE("moments: parts join to the whole, in any grouping") {
    moments whole, left, right;
    random_stream random(3, random_purposes::order);
    long double sum = 0, squares = 0;
    std::vector<double> values(1000);
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = 1e6 + random.normal();
        sum += values[i];
        (i < 300 ? left : right).add({1, values[i], 0});
    }
    for (const double v : values)
        squares += (v - sum / 1000) * (v - sum / 1000);
    whole.add(left);
    whole.add(moments{}); // nothing
    whole.add(right);
    CHECK(whole.count == 1000);
    // Each of n updates rounds a mean of 1e6; what that does to the squares is of the order of distance ×
    // error.
    const double error = accumulated(unit_roundoff<double>, 3000) * 1e6;
    CHECK(support::within(whole.mean, {static_cast<double>(sum / 1000), error}));
    CHECK(support::within(whole.variance(), {static_cast<double>(squares / 1000), 2 * 5 * error}));
    CHECK(moments{}.variance() == 0);
}

TEST_CASE("sum_terms: a million terms, with the error of a few") {
    constexpr std::size_t count = 1000000 / lanes<float>;
    const aligned_vector<float> v = draw_vectors<float>(count, 0, 1);
    long double sum = 0, squares = 0;
    float naive = 0;
    for (const float each : v) {
        sum += each, squares += static_cast<long double>(each) * each;
        naive += each;
    }
    const auto [found, found_squares] = sum_terms<2, float>(count, [&](std::size_t i) {
        const vector<float> x = load(v.data() + i * lanes<float>);
        return std::array<vector<float>, 2>{x, x * x};
    });
    const double exact = static_cast<double>(sum), exact_squares = static_cast<double>(squares);
    CHECK(support::within(found, {exact, accumulated(unit_roundoff<float>, run_length - 1) * exact}));
    CHECK(support::within(found_squares,
                          {exact_squares, accumulated(unit_roundoff<float>, run_length) * exact_squares}));
    // Random errors cancel: in fact near one rounding, where a plain sum loses two digits more.
    CHECK(std::abs(found - exact) <= unit_roundoff<float> * exact);
    CHECK(std::abs(static_cast<double>(naive) - exact) > unit_roundoff<float> * exact);
}

TEST_CASE_TEMPLATE("lanes_in_use: ones, then zeros", T, float, double) {
    for (std::size_t used = 0; used <= lanes<T>; ++used) {
        alignas(64) std::array<T, lanes<T>> flat;
        store(flat.data(), lanes_in_use<T>(used));
        for (std::size_t lane = 0; lane < lanes<T>; ++lane)
            CHECK(flat[lane] == (lane < used ? 1 : 0));
    }
}
