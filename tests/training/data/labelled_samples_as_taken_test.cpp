#include "../toy_task.hpp"

#include <tactnet/layers.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/training/data/labelled_samples.hpp>
#include <tactnet/training/loop/epoch_samples.hpp>
#include <tactnet/training/loop/trainable_network.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

using namespace tactnet;

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

TEST_CASE("images_as_taken: what is varied is the image as it was taken") {
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
    how.varies_as_taken = false;
    CHECK(v.image(how, v.images) == as_small);
    CHECK(!recipe::published(7, 13, published_training{}).varies_as_taken);
}

TEST_CASE("images_as_taken: images of another number or for another size are refused") {
    const varied v;
    labelled_images images = v.images;
    const auto told = [&] {
        try {
            labelled_samples(images).check(small, 3);
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    CHECK(told().empty());
    images.taken.pixels = images.taken.pixels.first(100);
    CHECK(told() == "images: expected 1092 pixels of images as taken, found 100");
    images.taken = images_as_taken::of<taken, shape{5, 7}>(v.task.pixels);
    CHECK(told() == "images: expected images as taken that are reduced to 4 x 7 x 1, found 5 x 7 x 1");
}

TEST_CASE("images_as_taken: nothing is written behind the small image") {
    const varied v;
    std::vector<float> made(small.size() + 4, -9.0F);
    v.images.taken.vary(image_transform{}, v.task.pixels.data(), made.data());
    for (std::size_t e = 0; e < made.size(); ++e)
        CHECK((made[e] == -9) == (e >= small.size()));
}
