#include "../toy_task.hpp"

#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/training/data/labelled_samples.hpp>
#include <tactnet/training/loop/epoch_samples.hpp>
#include <tactnet/training/loop/trainable.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <support/error_of.hpp>
#include <type_traits>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape size{1, 2};
constexpr std::array<std::size_t, 3> labels{0, 1, 1};
constexpr std::array<std::uint8_t, 6> pixels{1, 2, 3, 4, 255, 0};
constexpr std::array<float, 6> values{0.5F, -1, 2, 1e-30F, 4, 1e30F};

static_assert(borrowed_range<borrowed_span<const float>>);
static_assert(std::is_convertible_v<std::vector<float>&, borrowed_span<const float>>);
static_assert(std::is_convertible_v<const std::array<std::array<float, 3>, 2>&, borrowed_span<const float>>);
static_assert(std::is_convertible_v<std::span<const float>, borrowed_span<const float>>);
static_assert(!std::is_convertible_v<std::vector<float>, borrowed_span<const float>>);
static_assert(!std::is_convertible_v<std::vector<std::array<float, 3>>, borrowed_span<const float>>);
static_assert(!std::is_convertible_v<std::vector<std::array<double, 3>>&, borrowed_span<const float>>);

} // namespace

TEST_CASE("labelled_samples: images as their counts, features as they are") {
    const labelled_samples images = labelled_images{pixels, labels, 2},
                           features = labelled_features{values, labels, 2};
    CHECK(images.are_images());
    CHECK_FALSE(features.are_images());
    std::array<float, 2> of_image{}, of_features{};
    for (std::size_t i = 0; i < 3; ++i) {
        images.copy(i, of_image);
        features.copy(i, of_features);
        for (std::size_t e = 0; e < 2; ++e) {
            CHECK(of_image[e] == static_cast<float>(pixels[2 * i + e]));
            CHECK(of_features[e] == values[2 * i + e]);
        }
        CHECK(features.label(i) == labels[i]);
    }
    CHECK(features.size() == 3);
    CHECK(features.classes() == 2);
    CHECK(images.pixels().data() == pixels.data());
    CHECK_THROWS_AS(static_cast<void>(features.pixels()), std::logic_error);
}

TEST_CASE("labelled_samples: what does not fit a network is an error with the numbers") {
    const auto problem_of = [](const labelled_samples& samples, std::size_t outputs) {
        return support::error_of<std::invalid_argument>([&] { samples.check(size, outputs); });
    };
    CHECK(problem_of(labelled_images{pixels, labels, 2}, 2) == "no error");
    CHECK(problem_of(labelled_images{{}, {}, 1}, 1) == "no error");
    CHECK(problem_of(labelled_features{values, labels, 2}, 3) == "no error");
    CHECK(problem_of(labelled_features{values, labels, 2}, 1) ==
          "features: expected 1 to 1 classes, found 2");
    CHECK(problem_of(labelled_images{pixels, labels, 0}, 3) == "images: expected 1 to 3 classes, found 0");
    CHECK(problem_of(labelled_features{values, labels, 1}, 3) ==
          "features: expected labels below 1, found 1");
    std::vector<std::size_t> with_outlier(labels.begin(), labels.end());
    with_outlier.front() = no_class;
    const labelled_features outliers{values, with_outlier, 2};
    CHECK(problem_of(outliers, 2) == "no error");
    const std::vector<std::size_t> known{1}, all{1, 0};
    CHECK_NOTHROW(labelled_samples(outliers).check_classes(known));
    CHECK_THROWS_WITH_AS(labelled_samples(outliers).check_classes(all),
                         "features: expected samples of a class for validation and test, found an outlier, "
                         "sample 0",
                         std::invalid_argument);
    CHECK(problem_of(labelled_features{std::span(values).first(5), labels, 2}, 2) ==
          "features: expected 6 numbers, found 5");
    CHECK(problem_of(labelled_images{std::span(pixels).first(5), labels, 2}, 2) ==
          "images: expected 6 pixels, found 5");
}

TEST_CASE("labelled_samples: a feature that is not finite is an error with its place") {
    std::array<float, 6> broken = values;
    const labelled_samples features = labelled_features{broken, labels, 2};
    CHECK_NOTHROW(features.check_finite(size));
    CHECK_NOTHROW(labelled_samples(labelled_images{pixels, labels, 2}).check_finite(size));
    broken[3] = std::numeric_limits<float>::infinity();
    CHECK_THROWS_WITH_AS(features.check_finite(size),
                         "features: expected a finite number in sample 1, feature 1, found inf",
                         std::invalid_argument);
}

TEST_CASE("labelled_images: an image by its number") {
    constexpr shape picture{2, 3};
    std::vector<std::uint8_t> counts(3 * picture.size());
    std::iota(counts.begin(), counts.end(), std::uint8_t{0});
    const std::vector<std::size_t> classes{0, 1, 1};
    const labelled_images images{counts, classes, 2};
    const auto last = images.image<picture>(2);
    static_assert(last.extent == 6);
    CHECK(last.front() == 12);
    CHECK(last.back() == 17);
}

TEST_CASE("labelled_images: an array for each image") {
    constexpr shape picture{2, 3};
    std::vector<std::array<std::uint8_t, picture.size()>> arrays(2);
    arrays[1][5] = 7;
    const std::vector<std::size_t> classes{0, 1};
    const labelled_images images{arrays, classes, 2};
    CHECK(images.pixels.size() == 12);
    CHECK(images.pixels.data() == arrays[0].data());
    CHECK(images.image<picture>(1)[5] == 7);
    CHECK_NOTHROW(labelled_samples(images).check(picture, 2));
    const std::vector<std::array<std::uint8_t, picture.size()>> none;
    CHECK(labelled_images{none, {}, 2}.pixels.empty());
}

namespace {

constexpr shape taken = support::toy_task::size, small{4, 7};
using net = network<small, conv2d<2, 3>, relu, dense<3>>;

std::vector<std::uint8_t> reduced(const support::toy_task& task) {
    std::vector<std::uint8_t> all(task.labels.size() * small.size());
    for (std::size_t i = 0; i < task.labels.size(); ++i)
        resize<taken, small>(tensor_view<const std::uint8_t, taken>(task.pixels.data() + i * taken.size()),
                             tensor_view<std::uint8_t, small>(all.data() + i * small.size()));
    return all;
}

struct varied {
    support::toy_task task{4};
    std::vector<std::uint8_t> pixels = reduced(task);
    labelled_images images{pixels, task.labels, 3, images_as_taken::of<taken, small>(task.pixels)};
    std::vector<std::size_t> all = [this] {
        std::vector<std::size_t> places(task.labels.size());
        std::iota(places.begin(), places.end(), std::size_t{0});
        return places;
    }();

    /// Image 5 as it is in the third epoch.
    std::array<float, small.size()> image(const recipe& how, const labelled_images& of) const {
        thread_pool threads;
        const trainable_network<net> network;
        const epoch_samples shown(how, network, of, all, 1, threads);
        std::array<float, small.size()> made{};
        shown.make(5, 3, made);
        return made;
    }
};

} // namespace

TEST_CASE("images_as_taken: augmentation varies the image as it was taken") {
    const varied v;
    recipe how;
    how.ranges = {.reflect_rows = 0.5, .translation = 0.5, .rotation = 10};
    const auto found = v.image(how, v.images);

    // The same by hand, with the translation in tactels of the image as it was taken.
    augmentation_ranges ranges = how.ranges;
    CHECK(v.images.taken.tactels_for_one() == 13.0 / 7);
    ranges.translation *= 13.0 / 7;
    random_stream random(1, random_purposes::augmentation, 3, 5);
    tensor<float, taken> by_hand;
    transform_image<taken>(image_transform::draw(ranges, random),
                           v.images.taken.pixels.subspan<5 * taken.size(), taken.size()>(), by_hand.view());
    tensor<float, small> expected;
    resize<taken, small>(by_hand.view(), expected.view());
    for (std::size_t e = 0; e < small.size(); ++e)
        CHECK(found[e] == std::clamp(expected.data()[e], 0.0f, 255.0f));
}

TEST_CASE("images_as_taken: nothing done to one is the small image, but for its rounding") {
    const varied v;
    recipe how;
    how.ranges = {};
    const auto found = v.image(how, v.images);
    for (std::size_t e = 0; e < small.size(); ++e)
        CHECK(std::abs(found[e] - static_cast<float>(v.pixels[5 * small.size() + e])) <= 0.5001f);
}

TEST_CASE("images_as_taken: a recipe may vary the small ones, as the paper's does") {
    const varied v;
    recipe how;
    how.ranges = {.translation = 0.5, .rotation = 10};
    labelled_images alone = v.images;
    alone.taken = {};
    const auto as_small = v.image(how, alone);
    CHECK(v.image(how, v.images) != as_small);
    how.augment_full_resolution = false;
    CHECK(v.image(how, v.images) == as_small);
    CHECK(!recipe::published(7, 13, published_training{}).augment_full_resolution);
}

TEST_CASE("images_as_taken: images of another number or for another size are refused") {
    const varied v;
    labelled_images images = v.images;
    const auto problem_of = [&] {
        return support::error_of<std::invalid_argument>([&] { labelled_samples(images).check(small, 3); });
    };
    CHECK(problem_of() == "no error");
    images.taken.pixels = images.taken.pixels.first(100);
    CHECK(problem_of() == "images: expected 1092 pixels of images as taken, found 100");
    images.taken = images_as_taken::of<taken, shape{5, 7}>(v.task.pixels);
    CHECK(problem_of() == "images: expected images as taken that are reduced to 4 x 7 x 1, found 5 x 7 x 1");
}

TEST_CASE("images_as_taken: nothing is written past the small image") {
    const varied v;
    std::vector<float> made(small.size() + 4, -9.0F);
    v.images.taken.vary(image_transform{}, v.task.pixels.data(), made.data());
    for (std::size_t e = 0; e < made.size(); ++e)
        CHECK((made[e] == -9) == (e >= small.size()));
}
