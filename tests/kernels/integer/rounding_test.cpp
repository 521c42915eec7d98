#include <tactnet/kernels/integer/rounding.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>

// From sums to bytes: to the nearest, ties to the even one, within the range.

using namespace tactnet;

namespace {

constexpr std::size_t lanes = kernels::max_integer_lanes;

/// The range of the bytes, and the one that stands for zero.
struct limits {
    int lowest = 0, highest = 255, zero = 0;
};

/// One sum by a vector of every lane count at once: all must be the same byte.
template <std::size_t Lanes>
int by_lanes(std::int32_t sum, float factor, const limits& range) {
    kernels::int32_vec<Lanes> sums{};
    kernels::float_vec<Lanes> factors{};
    for (std::size_t l = 0; l < Lanes; ++l)
        sums[l] = sum, factors[l] = factor;
    std::array<std::uint8_t, Lanes + 8> bytes;
    bytes.fill(201);
    kernels::store_rounded<Lanes>(bytes.data(), sums, factors, {range.lowest, range.highest, range.zero});
    for (std::size_t l = 0; l < bytes.size(); ++l)
        if (bytes[l] != (l < Lanes ? bytes[0] : 201))
            return -1;
    return bytes[0];
}
int rounded(std::int32_t sum, float factor, const limits& range = {}) {
    const int one = by_lanes<1>(sum, factor, range);
    return by_lanes<lanes>(sum, factor, range) == one && by_lanes<4>(sum, factor, range) == one ? one : -1;
}
int expected(std::int32_t sum, float factor, const limits& range) {
    const float product = static_cast<float>(sum) * factor;
    return static_cast<int>(std::clamp<double>(std::nearbyint(static_cast<double>(product)) + range.zero,
                                               range.lowest, range.highest));
}

} // namespace

TEST_CASE("store_rounded: ties go to the even byte") {
    for (int byte = 0; byte < 254; ++byte) {
        const int even = byte % 2 == 0 ? byte : byte + 1;
        CHECK(rounded(2 * byte + 1, 0.5f) == even);
        CHECK(rounded(2 * byte, 0.5f) == byte);
    }
    // The value is rounded, not the byte: with an odd zero point, the ties of bytes are the odd ones.
    CHECK(rounded(-1, 0.5f, {0, 255, 7}) == 7);
    CHECK(rounded(1, 0.5f, {0, 255, 7}) == 7);
    CHECK(rounded(3, 0.5f, {0, 255, 7}) == 9);
    CHECK(rounded(-3, 0.5f, {0, 255, 7}) == 5);
}

TEST_CASE("store_rounded: bytes end at the range, whatever the sum") {
    constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max(),
                           least = std::numeric_limits<std::int32_t>::min();
    for (const float factor : {1e-9f, 0.001f, 1.0f, 1000.0f, 1e30f})
        for (const int zero : {0, 1, 128, 255})
            for (const std::int32_t sum : {most, most - 1, 1 << 22, (1 << 22) + 1, 1 << 23, 1 << 24, 300, 255,
                                           1, 0, -1, -255, -300, -(1 << 22), -(1 << 23), -(1 << 24), least})
                for (const int lowest : {0, zero}) {
                    const limits range{lowest, 255, zero};
                    CHECK(rounded(sum, factor, range) == expected(sum, factor, range));
                }
    CHECK(rounded(most, 1.0f) == 255);
    CHECK(rounded(least, 1.0f) == 0);
    CHECK(rounded(least, 1.0f, {128, 255, 128}) == 128);
}

TEST_CASE("store_rounded: drawn sums and factors give the nearest byte") {
    std::mt19937 draw(3);
    std::size_t wrong = 0;
    for (int i = 0; i < 100'000; ++i) {
        const auto sum = static_cast<std::int32_t>(draw()) >> draw() % 24;
        const float factor = std::ldexp(1.0f + static_cast<float>(draw() % 1024) / 1024,
                                        -static_cast<int>(draw() % 24)); // many ties
        const auto zero = static_cast<std::int32_t>(draw() % 256);
        const limits range{draw() % 2 == 0 ? 0 : zero, 255, zero};
        wrong += rounded(sum, factor, range) != expected(sum, factor, range);
    }
    CHECK(wrong == 0);
}

TEST_CASE("nearest: ties go to the even number up to 2^22") {
    const auto check = [](float value) {
        return kernels::nearest<1>(kernels::float_vec<1>{value})[0] ==
               std::nearbyint(static_cast<double>(value));
    };
    for (float whole = -2000; whole <= 2000; ++whole)
        for (const float part : {0.0f, 0.25f, 0.5f, 0.75f})
            CHECK(check(whole + part));
    for (const float large :
         {0x1p22f, -0x1p22f, 0x1p22f - 0.5f, 0.5f - 0x1p22f, 0x1p21f + 0.5f, 0x1p21f + 1.5f})
        CHECK(check(large));
}
