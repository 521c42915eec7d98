#include <tactnet/kernels/integer/elementwise.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

// From counts to words, any number of them: whole vectors, and what remains.

using namespace tactnet;

namespace {

constexpr float steps = 64, most = 500 * steps;

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
        return kernels::counts_to_words(from.data(), from.size(), mean.data(), steps, most, words.data());
    }
    /// Words that are not those of plain loops, with those behind the last that were touched.
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
