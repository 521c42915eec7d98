#include <tactnet/kernels/batch/normalisation.hpp>
#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <support/guarded_map.hpp>
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

namespace {

constexpr sliding_window window = sliding_window::over({4, 6, 1}, 2, 2, padding::same);
constexpr std::size_t pixels = 24, windows = 6;

} // namespace

TEST_CASE_TEMPLATE(
    "normalised_pool_forward: the largest of the normalised, a falling rule takes the smallest", T, float,
    double) {
    constexpr std::size_t width = lanes<T>;
    const auto input = support::whole_numbers<T>(pixels * width, 7919);
    aligned_vector<T> output(windows * width), chosen(windows * width), behind_chosen(windows * width);
    for (const T scale : {T{2}, T{-2}, T{0}}) {
        const normalising<T> rule{1, scale, 3};
        normalised_pool_forward<window>(rule, input.data(), output.data());
        choose_for_pool<window>(static_cast<T>((scale > 0) - (scale < 0)), input.data(), chosen.data());
        normalise_and_rectify(rule, chosen.data(), behind_chosen.data(), windows * width);
        for (std::size_t o = 0; o < windows; ++o)
            for (std::size_t lane = 0; lane < width; ++lane) {
                T best = -1000, behind = 0;
                for (std::size_t k = 0; k < 4; ++k) {
                    const T x = input[((o / 3 * 2 + k / 2) * 6 + o % 3 * 2 + k % 2) * width + lane];
                    if ((x - 1) * scale + 3 > best)
                        best = (x - 1) * scale + 3, behind = x;
                }
                CHECK(output[o * width + lane] == (best > 0 ? best : 0));
                CHECK(chosen[o * width + lane] == behind);
                CHECK(behind_chosen[o * width + lane] == output[o * width + lane]);
            }
    }
}
TEST_CASE_TEMPLATE("normalised_pool_forward: a NaN is kept, whatever comes before and after it", T, float,
                   double) {
    constexpr std::size_t width = lanes<T>;
    for (const std::size_t at : {0u, 1u, 6u, 7u}) {
        aligned_vector<T> input(pixels * width, T{5}), output(windows * width);
        input[at * width] = static_cast<T>(std::nan(""));
        normalised_pool_forward<window>(normalising<T>{0, 1, 0}, input.data(), output.data());
        const auto broken_alone = [&] {
            CHECK(std::isnan(output[0]));
            for (std::size_t i = 1; i < output.size(); ++i)
                CHECK(output[i] == 5);
        };
        broken_alone();
        for (const T sign : {T{1}, T{-1}, T{0}}) {
            choose_for_pool<window>(sign, input.data(), output.data());
            broken_alone();
            normalise_and_rectify(normalising<T>{0, 1, 0}, output.data(), output.data(), output.size());
            broken_alone();
        }
    }
}
TEST_CASE_TEMPLATE("normalised_pool_backward: the first of equal elements, none where ReLU is zero", T, float,
                   double) {
    constexpr std::size_t width = lanes<T>;
    const aligned_vector<T> input(pixels * width, T{5}), chosen(windows * width, T{5}),
        output_gradient(windows * width, T{7});
    aligned_vector<T> output(windows * width, T{5}), input_gradient(pixels * width, T{99});
    for (std::size_t lane = 0; lane < width; ++lane)
        output[lane] = 0; // the first window
    const normalising_gradient<T> rule{0, 0, 0, 2};
    normalised_pool_backward<window>(rule, lanes_in_use<T>(width), input.data(), output.data(), chosen.data(),
                                     output_gradient.data(), input_gradient.data());
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
        const bool first = pixel / 6 % 2 == 0 && pixel % 2 == 0;
        CHECK(input_gradient[pixel * width] == (first && pixel != 0 ? 14 : 0));
    }
}
