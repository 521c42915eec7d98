#include "images.hpp"

#include <tactnet/features/surf_words.hpp>

#include <doctest/doctest.h>

#include <array>
#include <limits>
#include <numeric>
#include <set>
#include <support/allocations.hpp>
#include <vector>

using namespace tactnet;
using namespace features_test;

namespace {

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

} // namespace

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
