#include <tactnet/kernels/integer/elementwise.hpp>
#include <tactnet/kernels/integer/rounding.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

using namespace tactnet;

// From counts to words, any number of them: whole vectors, and what remains.

namespace {

constexpr float steps = 64, largest_count = 500 * steps;

struct drawn_counts {
    std::vector<float> counts;
    std::vector<std::int16_t> mean, words;

    drawn_counts(std::size_t count, bool whole) : counts(count), mean(count), words(count + 8, -7) {
        std::mt19937 draw(static_cast<unsigned>(count));
        for (std::size_t i = 0; i < count; ++i) {
            const auto many = static_cast<float>(draw() % (256 * 128));
            counts[i] = whole ? std::floor(many / 128) : many / 128; // half of a step too
            mean[i] = static_cast<std::int16_t>(draw() % (200 * 64));
        }
    }
    template <class Count>
    bool fits(const std::vector<Count>& from) {
        return kernels::counts_to_words(from.data(), from.size(), mean.data(), steps, largest_count,
                                        words.data());
    }
    /// Words that are not those of plain loops, with those after the last that were touched.
    [[nodiscard]] std::size_t wrong() const {
        std::size_t differing = 0;
        for (std::size_t i = 0; i < words.size(); ++i)
            differing +=
                words[i] !=
                (i < counts.size() ? std::nearbyint(static_cast<double>(counts[i]) * 64) - mean[i] : -7);
        return differing;
    }
};

} // namespace

TEST_CASE("counts_to_words: any number of counts, in bytes and in floats") {
    for (std::size_t count = 1; count <= 70; ++count) {
        drawn_counts parts(count, false), whole(count, true);
        CHECK(parts.fits(parts.counts));
        CHECK(parts.wrong() == 0);
        CHECK(whole.fits(std::vector<std::uint8_t>(whole.counts.begin(), whole.counts.end())));
        CHECK(whole.wrong() == 0);
    }
}

TEST_CASE("counts_to_words: reports counts that words cannot hold, wherever they are") {
    constexpr std::size_t count = 37;
    drawn_counts drawn(count, false);
    std::vector<float> counts = drawn.counts;
    for (std::size_t i = 0; i < count; ++i) {
        const float middle = static_cast<float>(drawn.mean[i]) / steps;
        for (const float good : {middle + 500, middle - 500}) {
            counts[i] = good;
            CHECK(drawn.fits(counts));
        }
        for (const float bad :
             {middle + 500.0625f, middle - 500.0625f, 3e38f, -3e38f, std::numeric_limits<float>::infinity(),
              -std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
            counts[i] = bad;
            CHECK_FALSE(drawn.fits(counts));
        }
        counts[i] = drawn.counts[i];
    }
    CHECK(drawn.fits(counts));
    CHECK(drawn.wrong() == 0);
}

// Roots of whole numbers in bytes: against perfect squares, and against the rule in double precision.

namespace {

template <class Number>
std::vector<int> roots_of(const std::vector<Number>& numbers, std::int32_t zero, float offset, float factor,
                          const kernels::byte_range& range) {
    std::vector<std::uint8_t> bytes(numbers.size() + 4, 201);
    kernels::roots_to_bytes(numbers.data(), numbers.size(), zero, offset, factor, range, bytes.data());
    for (std::size_t i = numbers.size(); i < bytes.size(); ++i)
        CHECK(bytes[i] == 201); // nothing after the last
    return {bytes.begin(), bytes.end() - 4};
}

/// The rule: the root in single precision, a whole number of 1/1024, then one product in single precision.
/// A root in double precision has more than twice as many bits, so that rounding it gives the float that is
/// nearest to the exact root.
int expected_root(std::int64_t number, std::int32_t zero, float offset, float factor, int lowest,
                  int of_zero) {
    const auto parts = [&](std::int64_t above) {
        const float sum = static_cast<float>(above) + offset;
        const auto root = static_cast<float>(std::sqrt(static_cast<double>(sum)));
        return std::nearbyint(std::min(static_cast<double>(root), 4095.0) * 1024);
    };
    const double difference = parts(std::max<std::int64_t>(number - zero, 0)) - parts(0);
    const float product = static_cast<float>(difference) * factor;
    return static_cast<int>(
        std::clamp<double>(std::nearbyint(static_cast<double>(product)) + of_zero, lowest, 255));
}

} // namespace

TEST_CASE("roots_to_bytes: perfect squares give their roots, whatever stands for zero") {
    for (const std::int32_t zero : {0, 5, -300}) {
        std::vector<std::int16_t> squares;
        std::vector<int> roots;
        for (int root = 0; root <= 180; ++root)
            squares.push_back(static_cast<std::int16_t>(root * root + zero)), roots.push_back(root);
        CHECK(roots_of(squares, zero, 0, 1.0f / 1024, {}) == roots);
        for (int& root : roots)
            root = std::min(root + 100, 255);
        CHECK(roots_of(squares, zero, 0, 1.0f / 1024, {100, 255, 100}) == roots);
    }
    // √(n + 9/4) − 3/2 is whole where n = k (k + 3).
    std::vector<std::int16_t> numbers;
    std::vector<int> roots;
    for (int k = 0; k <= 170; ++k)
        numbers.push_back(static_cast<std::int16_t>(k * (k + 3))), roots.push_back(k);
    CHECK(roots_of(numbers, 0, 2.25f, 1.0f / 1024, {}) == roots);
}

TEST_CASE("roots_to_bytes: numbers below the zero give that of the zero, large ones the end of the range") {
    const std::vector<std::int16_t> below{-32768, -300, -1, 0, 6, 7};
    for (const float offset : {0.0f, 0.375f, 40.0f})
        CHECK(roots_of(below, 7, offset, 0.5f, {30, 255, 30}) == std::vector<int>(6, 30));
    CHECK(roots_of(std::vector<std::int16_t>{8, 32767}, 7, 0, 1, {0, 200, 30}) == std::vector<int>(2, 200));
    // Of roots beyond 4095 there is no difference any more: products stay within 32 bits.
    constexpr std::int32_t largest = std::numeric_limits<std::int32_t>::max();
    CHECK(roots_of(std::vector<std::int32_t>{0, 1, largest}, 0, 1e9f, 1, {0, 255, 9}) ==
          std::vector<int>(3, 9));
    CHECK(roots_of(std::vector<std::int32_t>{4094 * 4094, 4095 * 4095, 4096 * 4096, largest}, 0, 0,
                   1.0f / (16 * 1024), {}) == std::vector<int>{255, 255, 255, 255});
    CHECK(roots_of(std::vector<std::int32_t>{4095 * 4095, 4096 * 4096, largest}, 0, 0, 1.0f / (32 * 1024),
                   {}) == std::vector<int>{128, 128, 128}); // 127.97
}

TEST_CASE("roots_to_bytes: all words and bytes follow the rule, in any number") {
    std::vector<std::int16_t> words;
    for (int word = -32768; word <= 32767; ++word)
        words.push_back(static_cast<std::int16_t>(word));
    std::vector<std::uint8_t> bytes;
    for (int byte = 0; byte < 256; ++byte)
        bytes.push_back(static_cast<std::uint8_t>(byte));
    for (const float offset : {0.0f, 0.375f, 48.0f, 1234.5f})
        for (const float factor : {1.0f / 1024, 0.0021f, 0.013f}) {
            std::size_t wrong = 0;
            const std::vector<int> of_words = roots_of(words, 0, offset, factor, {3, 255, 3}),
                                   of_bytes = roots_of(bytes, 11, offset, factor, {3, 255, 3});
            for (std::size_t i = 0; i < words.size(); ++i)
                wrong += of_words[i] != expected_root(words[i], 0, offset, factor, 3, 3);
            for (std::size_t i = 0; i < bytes.size(); ++i)
                wrong += of_bytes[i] != expected_root(bytes[i], 11, offset, factor, 3, 3);
            CHECK(wrong == 0);
        }
    // Whole vectors and the rest after them.
    const std::vector<int> all = roots_of(bytes, 0, 0.375f, 0.01f, {});
    for (std::size_t count = 0; count <= 3 * kernels::lanes<float> + 1; ++count)
        CHECK(roots_of(std::vector<std::uint8_t>(bytes.begin() + 9,
                                                 bytes.begin() + 9 + static_cast<std::ptrdiff_t>(count)),
                       0, 0.375f, 0.01f, {}) ==
              std::vector<int>(all.begin() + 9, all.begin() + 9 + static_cast<std::ptrdiff_t>(count)));
}

// From sums to bytes: to the nearest, ties to the even one, within the range.

namespace {

constexpr std::size_t most_lanes = kernels::max_integer_lanes;

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
    return by_lanes<most_lanes>(sum, factor, range) == one && by_lanes<4>(sum, factor, range) == one ? one
                                                                                                     : -1;
}
int expected_byte(std::int32_t sum, float factor, const limits& range) {
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
                    CHECK(rounded(sum, factor, range) == expected_byte(sum, factor, range));
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
        wrong += rounded(sum, factor, range) != expected_byte(sum, factor, range);
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
