#include <tactnet/kernels/integer/elementwise.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

// From counts to words, any number of them: whole vectors, and what remains.

using namespace tactnet;

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
int expected(std::int64_t number, std::int32_t zero, float offset, float factor, int lowest, int of_zero) {
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
                wrong += of_words[i] != expected(words[i], 0, offset, factor, 3, 3);
            for (std::size_t i = 0; i < bytes.size(); ++i)
                wrong += of_bytes[i] != expected(bytes[i], 11, offset, factor, 3, 3);
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
