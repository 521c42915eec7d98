#include <tactnet/features/bag_of_words.hpp>
#include <tactnet/runtime/random.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <support/allocations.hpp>
#include <support/tolerance.hpp>
#include <vector>

using namespace tactnet;

namespace {

std::vector<float> random_rows(std::size_t count, std::size_t width, std::uint32_t number) {
    random_stream random(4, random_purposes::order, number);
    std::vector<float> rows(count * width);
    for (float& v : rows)
        v = static_cast<float>(static_cast<int>(random.below(2001)) - 1000) /
            64; // distances without rounding
    return rows;
}

template <std::size_t Values>
std::size_t nearest_by_force(std::span<const float> words, const float* descriptor) {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t w = 0; w < words.size() / Values; ++w) {
        double distance = 0;
        for (std::size_t v = 0; v < Values; ++v)
            distance +=
                std::pow(static_cast<double>(words[w * Values + v]) - static_cast<double>(descriptor[v]), 2);
        if (distance < least)
            least = distance, best = w;
    }
    return best;
}

template <std::size_t Values, std::size_t Words>
void compare(std::size_t word_count, std::size_t descriptor_count) {
    const auto words = random_rows(word_count, Values, 1),
               descriptors = random_rows(descriptor_count, Values, 2);
    std::vector<double> counts(Words);
    for (std::size_t d = 0; d < descriptor_count; ++d)
        ++counts[nearest_by_force<Values>(words, descriptors.data() + d * Values)];
    for (const histogram_form form : {histogram_form::counts, histogram_form::square_roots}) {
        const bag_of_words<Values, Words> bag(words, form);
        std::array<float, Words> histogram;
        histogram.fill(99);
        bag.encode(descriptors, histogram);
        double squares = 0;
        const auto term = [&](double n) { return form == histogram_form::counts ? n : std::sqrt(n); };
        for (const double n : counts)
            squares += term(n) * term(n);
        for (std::size_t w = 0; w < Words; ++w) {
            const double expected = descriptor_count > 0 ? term(counts[w]) / std::sqrt(squares) : 0;
            // The root, the length and their product are rounded.
            CHECK(std::abs(static_cast<double>(histogram[w]) - expected) <=
                  support::accumulated(support::unit_roundoff<float>, 4) * expected);
        }
    }
}

} // namespace

// Words of ±16 at 65536, each descriptor a quarter away from its own: the squares are 2e10, the distances 1.
TEST_CASE("bag_of_words: words far from zero, against the nearest by force") {
    auto words = random_rows(37, 5, 1);
    for (float& v : words)
        v += 65536;
    std::vector<float> descriptors(500 * 5);
    for (std::size_t e = 0; e < descriptors.size(); ++e)
        descriptors[e] = words[e % words.size()] + (e % 3 == 0 ? 0.25f : -0.25f);
    std::vector<double> counts(40);
    for (std::size_t d = 0; d < 500; ++d)
        ++counts[nearest_by_force<5>(words, descriptors.data() + d * 5)];
    double squares = 0;
    for (const double n : counts)
        squares += n * n;
    const bag_of_words<5, 40> bag(words);
    std::array<float, 40> histogram;
    bag.encode(descriptors, histogram);
    for (std::size_t w = 0; w < 40; ++w)
        CHECK(std::abs(static_cast<double>(histogram[w]) - counts[w] / std::sqrt(squares)) <=
              support::accumulated(support::unit_roundoff<float>, 4) * counts[w]);
}

TEST_CASE("bag_of_words: against the nearest words by force") {
    compare<64, 500>(500, 340);
    compare<64, 500>(37, 701);
    compare<5, 7>(7, 100);
    compare<1, 3>(1, 4);
    compare<64, 500>(500, 1);
    compare<64, 500>(500, 0);
}

TEST_CASE("bag_of_words: what it holds") {
    const auto words = random_rows(3, 4, 3);
    const bag_of_words<4, 10> bag(words, histogram_form::square_roots);
    CHECK(bag.count() == 3);
    CHECK(std::equal(words.begin(), words.end(), bag.words().begin(), bag.words().end()));
    CHECK(bag.form() == histogram_form::square_roots);
}

TEST_CASE("bag_of_words: words that are the same count for the first") {
    const std::vector<float> words{2, 2, 1, 1, 1, 1}, descriptors{1, 1, 1, 1};
    std::array<float, 3> histogram;
    bag_of_words<2, 3> bag(words);
    bag.encode(descriptors, histogram);
    CHECK(histogram == std::array<float, 3>{0, 1, 0});
}

TEST_CASE("bag_of_words: no heap in a call") {
    const auto words = random_rows(500, 64, 4), descriptors = random_rows(340, 64, 5);
    const bag_of_words<64, 500> bag(words, histogram_form::square_roots);
    std::array<float, 500> histogram;
    const std::size_t before = support::allocations();
    bag.encode(descriptors, histogram);
    CHECK(support::allocations() == before);
}

TEST_CASE("bag_of_words: rejected arguments and their messages") {
    using bag = bag_of_words<2, 2>;
    CHECK_THROWS_WITH(bag(std::vector<float>{}),
                      "bag_of_words: expected points of 2 numbers each, found 0 numbers");
    CHECK_THROWS_WITH(bag(std::vector<float>(3)),
                      "bag_of_words: expected points of 2 numbers each, found 3 numbers");
    CHECK_THROWS_WITH(bag(std::vector<float>(6)), "bag_of_words: expected at most 2 words, found 3");
    CHECK_THROWS_WITH(
        bag(std::vector<float>{0, std::numeric_limits<float>::infinity()}),
        "bag_of_words: expected finite numbers of at most 1e17, found inf as number 1 of point 0 "
        "(counted from 0)");
}
