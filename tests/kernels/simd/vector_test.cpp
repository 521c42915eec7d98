#include <tactnet/kernels/simd/row_vector.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/transpose.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <support/guarded_map.hpp>
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
                    quotient = stored<T>(kernels::quotient(x, y)),
                    joined = stored<T>(multiply_add<T>(x, y, z)),
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

TEST_CASE_TEMPLATE("quotient: rounded once, as square_root, at the ends of the range too", T, float, double) {
    using limits = std::numeric_limits<T>;
    const T numbers[] = {T(1),
                         T(3),
                         T(-0.7),
                         limits::max(),
                         limits::min(),
                         T(5) / T(1e3),
                         limits::infinity(),
                         3 * limits::denorm_min()};
    for (const T a : numbers) {
        if (a > 0)
            CHECK(stored<T>(square_root<T>(vector<T>(a)))[0] == std::sqrt(a));
        for (const T b : numbers)
            if (std::isfinite(a) || std::isfinite(b))
                CHECK(stored<T>(quotient(vector<T>(a), vector<T>(b)))[0] == a / b);
    }
}

TEST_CASE("padded_size: up to whole vectors") {
    CHECK(padded_size<float>(0) == 0);
    CHECK(padded_size<float>(1) == lanes<float>);
    CHECK(padded_size<float>(lanes<float>) == lanes<float>);
    CHECK(padded_size<float>(lanes<float> + 1) == 2 * lanes<float>);
}

namespace {

/// Numbers whose sum depends on the order: one so large that those after it are lost in it one by one, but
/// not together.
template <std::size_t Lanes>
void check_order() {
    aligned_vector<float> values(Lanes);
    for (std::size_t i = 0; i < Lanes; ++i)
        values[i] = i == 0 ? 0x1p24F : 1.0F;
    float in_float = 0;
    double in_double = 3;
    for (const float value : values) {
        in_float += value;
        in_double += static_cast<double>(value);
    }
    const auto whole = load_as<sized_vector<float, Lanes>>(values.data());
    CHECK(add_lanes<float, Lanes>(whole) == in_float);
    CHECK(add_lanes<float, Lanes>(whole, 3.0) == in_double);
}

} // namespace

TEST_CASE("add_lanes: one after the other") {
    check_order<min_lanes<float>>();
    check_order<lanes<float>>();
}

TEST_CASE("add_each_lane: to totals in double") {
    aligned_vector<float> values(lanes<float>);
    aligned_vector<double> totals(lanes<float> + 1, 1e9);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<float>(i) + 0.125F;
    add_each_lane<float>(totals.data(), load(values.data()));
    for (std::size_t i = 0; i < values.size(); ++i)
        CHECK(totals[i] == 1e9 + static_cast<double>(values[i]));
    CHECK(totals.back() == 1e9);
}

TEST_CASE_TEMPLATE("transpose: rows become columns, at any distance from each other", T, float, double) {
    constexpr std::size_t width = lanes<T>, from_stride = 3 * width, to_stride = width + 1; // not aligned
    aligned_vector<T> from(width * from_stride), to(width * to_stride, T{-1});
    for (std::size_t i = 0; i < from.size(); ++i)
        from[i] = static_cast<T>(i);
    transpose(from.data(), from_stride, to.data(), to_stride);
    for (std::size_t i = 0; i < width; ++i) {
        for (std::size_t j = 0; j < width; ++j)
            CHECK(to[i * to_stride + j] == from[j * from_stride + i]);
        CHECK(to[i * to_stride + width] == T{-1}); // between the rows
    }
}

TEST_CASE_TEMPLATE("transpose: features and samples change places, zeros after the last feature", T, float,
                   double) {
    constexpr std::size_t width = lanes<T>;
    const aligned_vector<T> from = support::whole_numbers<T>(width * width, 7919);
    for (std::size_t features = 1; features <= width; ++features) {
        aligned_vector<T> to(width * width, T{99});
        transpose(from.data(), features, to.data());
        for (std::size_t sample = 0; sample < width; ++sample)
            for (std::size_t f = 0; f < width; ++f)
                CHECK(to[sample * width + f] == (f < features ? from[f * width + sample] : T{}));
    }
}

namespace {

template <std::size_t Lanes>
using width = constant<Lanes>;

template <class Vector>
inline constexpr std::size_t size_of = sizeof(Vector) / sizeof(float);

/// begin, begin + 1 … without alignment.
template <class Vector>
Vector counting(float begin) {
    std::array<float, size_of<Vector> + 1> values;
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = begin + static_cast<float>(i) - 1;
    return load_unaligned<Vector>(values.data() + 1);
}
template <class Vector>
std::array<float, size_of<Vector>> elements(const Vector& v) {
    std::array<float, size_of<Vector> + 1> values;
    store_anywhere(values.data() + 1, v);
    std::array<float, size_of<Vector>> result;
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = values[i + 1];
    return result;
}

} // namespace

TEST_CASE_TEMPLATE("row_vector: every operation, lane by lane", Width, width<lanes<float>>,
                   width<min_lanes<float>>) {
    constexpr std::size_t n = Width::value;
    using wide = sized_vector<float, n>;
    constexpr float infinity = std::numeric_limits<float>::infinity(),
                    not_a_number = std::numeric_limits<float>::quiet_NaN();
    const wide a = counting<wide>(-2.25f);
    const auto kept = elements(clamp(a, wide(-1.5f), wide(0.5f))), whole = elements(truncate(a)),
               zeros = elements(select_if_zero(counting<wide>(-1), wide(7), a));
    std::array<std::int32_t, n + 1> numbers{};
    store_int32(numbers.data() + 1, a);
    std::array<std::uint8_t, n + 1> bytes;
    for (std::size_t i = 0; i <= n; ++i)
        bytes[i] = static_cast<std::uint8_t>(256 - i);
    const auto of_bytes = elements(load_floats<wide>(bytes.data() + 1));
    for (std::size_t i = 0; i < n; ++i) {
        CHECK(of_bytes[i] == 255 - static_cast<float>(i));
        const float value = -2.25f + static_cast<float>(i);
        CHECK(elements(a)[i] == value);
        CHECK(kept[i] == std::fmin(std::fmax(value, -1.5f), 0.5f));
        CHECK(whole[i] == std::trunc(value));
        CHECK(numbers[i + 1] == static_cast<std::int32_t>(value));
        CHECK(zeros[i] == (i == 1 ? 7 : value));
    }
    CHECK(elements(clamp(wide(not_a_number), wide(1), wide(2)))[0] == 1);
    CHECK(elements(clamp(wide(infinity), wide(1), wide(2)))[0] == 2);
    CHECK(all_finite(a));
    for (const float broken : {infinity, -infinity, not_a_number}) {
        std::array<float, n> values{};
        values[n - 1] = broken;
        CHECK_FALSE(all_finite(load_unaligned<wide>(values.data())));
    }
}

TEST_CASE_TEMPLATE("row_vector: interleave, deinterleave and spread", Width, width<lanes<float>>,
                   width<min_lanes<float>>) {
    constexpr std::size_t n = Width::value;
    using wide = sized_vector<float, n>;
    std::array<wide, 8> sequence;
    for (std::size_t v = 0; v < 8; ++v)
        sequence[v] = counting<wide>(static_cast<float>(v * n));
    const auto eight = deinterleave(sequence);
    const auto two = deinterleave(std::array{sequence[0], sequence[1]});
    const auto both = interleave(sequence[0], sequence[1]);
    const auto three = repeat_three(sequence[1]);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t way = 0; way < 8; ++way)
            CHECK(elements(eight[way])[i] == static_cast<float>(8 * i + way));
        for (std::size_t way = 0; way < 2; ++way) {
            CHECK(elements(two[way])[i] == static_cast<float>(2 * i + way));
            const std::size_t place = way * n + i;
            CHECK(elements(both[way])[i] == static_cast<float>(place / 2 + place % 2 * n));
        }
        for (std::size_t part = 0; part < 3; ++part)
            CHECK(elements(three[part])[i] == static_cast<float>(n + (part * n + i) / 3));
    }
}

TEST_CASE("row_vector: cover a row, and nothing beyond it where it is long enough") {
    for (const std::size_t width : {1u, 4u, 8u, 16u})
        for (std::size_t count = 1; count < 60; ++count) {
            std::size_t covered = 0;
            for (std::size_t v = 0; v < row_vectors(count, width); ++v) {
                const std::size_t begin = row_vector_begin(v, count, width);
                CHECK(begin <= covered);
                CHECK((begin + width <= count || count < width));
                covered = begin + width;
            }
            CHECK(covered >= count);
        }
    CHECK(row_lanes<float>(1) == min_lanes<float>);
    CHECK(row_lanes<float>(16 * lanes<float>) == lanes<float>);
}

TEST_CASE("store_in_row: no more than the row holds") {
    std::array<float, 3 + 4> row;
    row.fill(-1);
    using wide = sized_vector<float, min_lanes<float>>;
    constexpr std::size_t count = min_lanes<float> == 1 ? 1 : 3;
    store_in_row<count, min_lanes<float>>(row.data(), counting<wide>(5));
    for (std::size_t i = 0; i < row.size(); ++i)
        CHECK(row[i] == (i < count ? 5 + static_cast<float>(i) : -1));
}
