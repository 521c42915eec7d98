#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/simd/special_functions.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <tuple>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

std::array<float, lanes<float>> exponentials(const std::array<float, lanes<float>>& x) {
    alignas(vector_alignment) std::array<float, lanes<float>> in = x, out;
    store(out.data(), exponential(load(in.data())));
    return out;
}
float exponential_of(float x) {
    std::array<float, lanes<float>> all{};
    all.back() = x;
    return exponentials(all).back();
}

/// Error in units in the last place of the exact value.
double error_in_ulp(float x) {
    const double exact = std::exp(static_cast<double>(x));
    const int exponent = std::ilogb(exact);
    return std::abs(static_cast<double>(exponential_of(x)) - exact) / std::ldexp(1.0, exponent - 23);
}

} // namespace

TEST_CASE("exponential: within 1.5 units in the last place wherever the result is a normal number") {
    // One in 997 of all floats between the ends, of both signs.
    double worst = 0;
    for (const float end : {-0x1.5d589ep6F, 0x1.62e42ep6F}) {
        const std::uint32_t sign = tactnet::detail::bits_as<std::uint32_t>(end) & 0x80000000U;
        const std::uint32_t last = tactnet::detail::bits_as<std::uint32_t>(end) & 0x7FFFFFFFU;
        for (std::uint32_t bits = 0; bits <= last; bits += 997)
            worst = std::max(worst, error_in_ulp(tactnet::detail::bits_as<float>(sign | bits)));
        worst = std::max(worst, error_in_ulp(end));
    }
    MESSAGE("largest error: " << worst << " ulp");
    CHECK(worst <= 1.5);
}

TEST_CASE("exponential: exact at 0, beyond the range 0 and infinity, NaN stays NaN") {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    CHECK(exponential_of(0) == 1);
    CHECK(exponential_of(-0.0F) == 1);
    CHECK(exponential_of(-infinity) == 0);
    CHECK(exponential_of(-87.34F) == 0);
    CHECK(exponential_of(-1e30F) == 0);
    CHECK(exponential_of(88.73F) == infinity);
    CHECK(exponential_of(1e30F) == infinity);
    CHECK(exponential_of(infinity) == infinity);
    CHECK(std::isnan(exponential_of(std::numeric_limits<float>::quiet_NaN())));
}

TEST_CASE("exponential: negative exponentials of distances, with any factor") {
    aligned_vector<float> values(4 * lanes<float>);
    values[1] = 2;
    values.back() = 3;
    aligned_vector<float> far = values;
    negative_exponentials(values.data(), values.size(), 0.5F);
    CHECK(values[0] == 1);
    CHECK(values[1] == doctest::Approx(std::exp(-1.0)).epsilon(1e-6));
    CHECK(values.back() == doctest::Approx(std::exp(-1.5)).epsilon(1e-6));
    negative_exponentials(far.data(), far.size(), std::numeric_limits<float>::max());
    CHECK(far[0] == 1);
    CHECK(far[1] == 0);
}

namespace {

/// The largest error in units in the last place over floats from `first` to `last`, one in 997 of them. Units
/// do not become smaller than that of the smallest normal number.
double worst_error(float first, float last, vector<float> (*function)(const vector<float>&),
                   double (*exact)(double)) {
    double worst = 0;
    const auto from = tactnet::detail::bits_as<std::uint32_t>(first),
               to = tactnet::detail::bits_as<std::uint32_t>(last);
    for (std::uint32_t bits = std::min(from, to); bits <= std::max(from, to); bits += 997 * lanes<float>) {
        alignas(vector_alignment) std::array<float, lanes<float>> x, y;
        for (std::size_t lane = 0; lane < lanes<float>; ++lane)
            x[lane] = tactnet::detail::bits_as<float>(
                std::min(bits + 997 * static_cast<std::uint32_t>(lane), std::max(from, to)));
        store(y.data(), function(load(x.data())));
        for (std::size_t lane = 0; lane < lanes<float>; ++lane) {
            const double right = exact(static_cast<double>(x[lane]));
            const int exponent = std::max(right == 0 ? -126 : std::ilogb(right), -126);
            worst = std::max(worst,
                             std::abs(static_cast<double>(y[lane]) - right) / std::ldexp(1.0, exponent - 23));
        }
    }
    return worst;
}
double exact_tail(double x) {
    return std::erfc(x / std::sqrt(2.0)) / 2;
}
double relative_error(double found, double exact) {
    return exact == 0 ? std::abs(found) : std::abs(found / exact - 1);
}

} // namespace

TEST_CASE("special_functions: within their units in the last place, one in 997 floats") {
    const auto tangent = [](const vector<float>& x) { return hyperbolic_tangent(x); };
    const auto exact_tangent = [](double x) { return std::tanh(x); };
    const double errors[] = {
        worst_error(0, 20, tangent, exact_tangent),
        worst_error(-0.0F, -20, tangent, exact_tangent),
        worst_error(
            0, 1, [](const vector<float>& x) { return log_one_plus(x); },
            [](double x) { return std::log1p(x); }),
        worst_error(
            -0.0F, -87, [](const vector<float>& x) { return exponential_of_negative(x); },
            [](double x) { return std::exp(x); }),
        worst_error(
            -0.0F, -87, [](const vector<float>& x) { return exponential_minus_one(x); },
            [](double x) { return std::expm1(x); }),
        worst_error(
            0, 13, [](const vector<float>& x) { return normal_tail(x); }, exact_tail),
        worst_error(
            0, 13, [](const vector<float>& x) { return normal_density(x); },
            [](double x) { return std::exp(-x * x / 2) / std::sqrt(2 * std::acos(-1.0)); })};
    const double bounds[] = {2, 2, 2, 1.5, 2, 8, 4};
    for (std::size_t f = 0; f < std::size(bounds); ++f) {
        MESSAGE(f << ": " << errors[f] << " ulp");
        CHECK(errors[f] <= bounds[f]);
    }
}

TEST_CASE("special_functions: in double, within 10⁻¹² of the standard library's") {
    using namespace tactnet::detail;
    double worst = 0;
    for (double x = -30; x < 30; x += 0.0037) {
        worst = std::max(worst, relative_error(exponential(x), std::exp(x)));
        worst = std::max(worst, relative_error(tactnet::detail::hyperbolic_tangent(x), std::tanh(x)));
        if (x >= 0) {
            worst = std::max(worst, relative_error(tactnet::detail::normal_tail(x), exact_tail(x)));
            worst =
                std::max(worst, relative_error(tactnet::detail::log_one_plus(x / 30), std::log1p(x / 30)));
        }
    }
    MESSAGE("largest relative error: " << worst);
    CHECK(worst <= 1e-12);
}

TEST_CASE("special_functions: constexpr, with the limits at the ends, NaN stays NaN") {
    using tactnet::detail::exponential, tactnet::detail::hyperbolic_tangent, tactnet::detail::normal_tail;
    static_assert(exponential(0.0) == 1 && exponential(-1e9) == 0);
    static_assert(exponential(709.7) > 1e308 && exponential(710.0) > std::numeric_limits<double>::max());
    static_assert(hyperbolic_tangent(0.0) == 0 && hyperbolic_tangent(100.0) == 1 &&
                  hyperbolic_tangent(-1e300) == -1);
    static_assert(normal_tail(0.0) == 0.5 && normal_tail(50.0) == 0);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(std::isnan(exponential(nan)));
    CHECK(std::isnan(hyperbolic_tangent(nan)));
    CHECK(std::isnan(normal_tail(nan)));
    const float large = std::numeric_limits<float>::max();
    alignas(vector_alignment) std::array<float, lanes<float>> x, y;
    x.fill(large);
    store(y.data(), kernels::normal_tail(load(x.data())));
    CHECK(y[0] == 0);
}

TEST_CASE("special_functions: the same bits in vectors of every width, the limits beyond the range") {
    const auto of_width = [](auto width, const auto& function, const float* from, float* to) {
        using wide = sized_vector<float, width>;
        for (std::size_t i = 0; i < 16; i += width)
            store_as(to + i, function(load_as<wide>(from + i)));
    };
    const auto functions = std::tuple{[](const auto& x) { return exponential_of_negative(x); },
                                      [](const auto& x) { return exponential_minus_one(x); },
                                      [](const auto& x) { return hyperbolic_tangent(x); },
                                      [](const auto& x) { return normal_tail(magnitude(x)); }};
    constexpr float infinity = std::numeric_limits<float>::infinity();
    alignas(vector_alignment) const std::array<float, 16> x{-0.0F, -1e-30F, -0.3F,     -1,  -2.5F,  -7,
                                                            -13,   -13.26F, -30,       -87, -87.6F, -88,
                                                            -1e9F, -1e38F,  -infinity, NAN};
    std::apply(
        [&](const auto&... function) {
            const auto check = [&](const auto& f) {
                alignas(vector_alignment) std::array<float, 16> widest, narrow;
                of_width(constant<lanes<float>>{}, f, x.data(), widest.data());
                of_width(constant<min_lanes<float>>{}, f, x.data(), narrow.data());
                CHECK(std::memcmp(widest.data(), narrow.data(), sizeof(widest)) == 0);
                CHECK(std::isnan(widest[15]));
                return widest[14];
            };
            const std::array limits{check(function)...};
            CHECK(limits[0] == 0);
            CHECK(limits[1] == -1);
            CHECK(limits[2] == -1);
            CHECK(limits[3] == 0);
        },
        functions);
}

TEST_CASE("special_functions: at_least, at_most, maximum_or_second: NaN and zeros of opposite signs in "
          "vectors of every width") {
    const auto check = [](auto width) {
        using wide = sized_vector<float, width>;
        const auto every = [](const wide& v, const auto& holds) {
            alignas(vector_alignment) std::array<float, decltype(width)::value> to;
            store_as(to.data(), v);
            return std::all_of(to.begin(), to.end(), holds);
        };
        const auto is = [&](const wide& v, float expected) {
            return every(v,
                         [=](float x) { return x == expected && std::signbit(x) == std::signbit(expected); });
        };
        const auto is_nan = [&](const wide& v) { return every(v, [](float x) { return std::isnan(x); }); };
        const wide negative_zero(-0.0F), zero(0.0F), one(1.0F), broken(NAN);
        CHECK(is(at_least(zero, one), 1));
        CHECK(is(at_least(one, zero), 1));
        CHECK(is(at_most(zero, one), 0));
        CHECK(is(at_most(one, zero), 0));
        for (const wide& limit : {negative_zero, zero, one}) {
            CHECK(is_nan(at_least(limit, broken)));
            CHECK(is_nan(at_most(limit, broken)));
            CHECK(is_nan(maximum_or_second(limit, broken)));
            CHECK_FALSE(is_nan(maximum_or_second(broken, limit)));
        }
#if defined(__aarch64__) && !defined(TACTNET_NO_SIMD)
        const float larger = 0, smaller = -0.0F; // whichever is x
#else
        const float larger = -0.0F, smaller = 0; // x
#endif
        CHECK(is(at_least(zero, negative_zero), larger));
        CHECK(is(at_most(negative_zero, zero), smaller));
        CHECK(is(at_least(negative_zero, zero), 0));
        CHECK(is(at_most(zero, negative_zero), -0.0F));
        CHECK(is(maximum_or_second(zero, negative_zero), -0.0F));
        CHECK(is(maximum_or_second(negative_zero, zero), 0));
    };
    check(constant<min_lanes<float>>{});
    check(constant<lanes_for<float>(8)>{});
    check(constant<lanes<float>>{});
}
