#include <tactnet/kernels/simd/exponential.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

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
