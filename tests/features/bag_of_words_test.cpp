#include "images.hpp"

#include <tactnet/features/bag_of_words.hpp>
#include <tactnet/runtime/random.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <support/allocations.hpp>
#include <support/tolerance.hpp>
#include <vector>

namespace {

using namespace tactnet;
using namespace features_test;

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

constexpr shape size{14, 25};
constexpr std::size_t words = 40;
using counts_surf = dense_surf<size>;
using real_surf = dense_surf<size, surf_grid{}, float>;

/// Image 2 is empty.
template <class Pixel>
std::vector<Pixel> some_images(std::size_t count) {
    std::vector<Pixel> images;
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto image = i == 2 ? tensor<Pixel, size>{} : random_image<Pixel, size>(i);
        images.insert(images.end(), image.begin(), image.end());
    }
    return images;
}

std::vector<std::size_t> first_ones(std::size_t count) {
    std::vector<std::size_t> chosen(count);
    std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    return chosen;
}

TEST_CASE("surf_histogram: words of some images, histograms of all, one by one and together") {
    const std::vector<std::uint8_t> images = some_images<std::uint8_t>(12);
    const auto chosen = first_ones(10);
    thread_pool one(1), three(3);
    const surf_settings settings{.max_descriptors = 600};
    const auto bag = fit_surf_words<counts_surf, words>(images, chosen, settings, one);
    CHECK(bag.count() == words);
    CHECK(bag.form() == settings.form);
    const auto again = fit_surf_words<counts_surf, words>(images, chosen, settings, three);
    CHECK(std::equal(bag.words().begin(), bag.words().end(), again.words().begin(), again.words().end()));

    const std::vector<std::size_t> wanted{11, 2, 0};
    const auto histograms = surf_histograms<counts_surf>(images, wanted, bag, three);
    REQUIRE(histograms.size() == 3 * words);
    counts_surf memory;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        std::array<float, words> histogram{};
        const std::size_t before = support::allocations();
        const bool finite =
            surf_histogram(memory, bag, counts_surf::image_view(images.data() + wanted[i] * size.size()),
                           std::span(histogram));
        CHECK(support::allocations() == before);
        CHECK(finite);
        CHECK(std::equal(histogram.begin(), histogram.end(),
                         histograms.begin() + static_cast<std::ptrdiff_t>(i * words)));
        const double squares = std::inner_product(histogram.begin(), histogram.end(), histogram.begin(), 0.0);
        CHECK(squares == doctest::Approx(wanted[i] == 2 ? 0 : 1));
    }
}

TEST_CASE("fit_surf_words: fewer descriptors than words") {
    std::vector<std::uint8_t> images(size.size());
    images[0] = 1;
    thread_pool one(1);
    const auto bag = fit_surf_words<counts_surf, 500>(images, first_ones(1), {}, one);
    counts_surf memory;
    REQUIRE(memory.describe(counts_surf::image_view(images.data())));
    std::set<std::vector<float>> different; // every one of them is a word
    for (std::size_t d = 0; d < memory.places().size(); ++d) {
        const auto descriptor = memory.descriptors().subspan(d * surf_values, surf_values);
        different.emplace(descriptor.begin(), descriptor.end());
    }
    CHECK(bag.count() > 1);
    CHECK(bag.count() == different.size());
    std::array<float, 500> histogram;
    CHECK(surf_histogram(memory, bag, counts_surf::image_view(images.data()), std::span(histogram)));
    for (std::size_t w = bag.count(); w < 500; ++w)
        CHECK(histogram[w] == 0);
}

TEST_CASE("fit_surf_words: the seed, the descriptors and the iterations matter") {
    const std::vector<std::uint8_t> images = some_images<std::uint8_t>(8);
    thread_pool one(1);
    const auto words_with = [&](const surf_settings& settings) {
        const auto bag = fit_surf_words<counts_surf, words>(images, first_ones(8), settings, one);
        return std::vector<float>(bag.words().begin(), bag.words().end());
    };
    const auto expected = words_with({.max_descriptors = 300});
    CHECK(words_with({.max_descriptors = 300}) == expected);
    CHECK(words_with({.max_descriptors = 400}) != expected);
    CHECK(words_with({.max_descriptors = 300, .seed = 2}) != expected);
    CHECK(words_with({.max_descriptors = 300, .max_iterations = 1}) != expected);
}

TEST_CASE("fit_surf_words: rejected arguments and their messages") {
    thread_pool two(2);
    std::vector<float> images = some_images<float>(6);
    images[4 * size.size() + 7] = std::numeric_limits<float>::quiet_NaN();
    images[5 * size.size()] = std::numeric_limits<float>::infinity();
    using fit = bag_of_words<surf_values, words>;
    const auto words_of = [&](const std::vector<std::size_t>& chosen) -> fit {
        return fit_surf_words<real_surf, words>(images, chosen, {}, two);
    };
    CHECK_THROWS_WITH(
        words_of({0, 5, 4}),
        "dense SURF: expected finite pixels, found NaN or infinity in image 4 (counted from 0)");
    CHECK_THROWS_WITH(
        words_of({0, 4, 5}),
        "dense SURF: expected finite pixels, found NaN or infinity in image 4 (counted from 0)");
    CHECK_THROWS_WITH(words_of({0, 6}), "dense SURF: there is no image 6 among 6");
    CHECK_THROWS_WITH(words_of({2, 2}),
                      "dense SURF: found nothing to describe in 2 images: all of them are zero");
    CHECK_THROWS_WITH(words_of({}),
                      "dense SURF: found nothing to describe in 0 images: all of them are zero");
    const fit bag = words_of({0, 1, 3});
    const std::vector<std::size_t> broken{4};
    CHECK_THROWS_AS(static_cast<void>(surf_histograms<real_surf>(images, broken, bag, two)),
                    std::invalid_argument);
    real_surf memory;
    std::array<float, words> histogram{};
    histogram.fill(99);
    CHECK(!surf_histogram(memory, bag, real_surf::image_view(images.data() + 4 * size.size()),
                          std::span(histogram)));
    CHECK(std::all_of(histogram.begin(), histogram.end(), [](float v) { return v == 0; }));
}

} // namespace
