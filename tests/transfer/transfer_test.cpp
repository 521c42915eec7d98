#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/transfer/as_photograph.hpp>
#include <tactnet/transfer/networks.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

namespace {

using namespace tactnet;

constexpr shape grey{9, 14}, large{31, 27, 3};

std::vector<std::uint8_t> touch() {
    std::vector<std::uint8_t> image(grey.size());
    for (std::size_t e = 0; e < image.size(); ++e)
        image[e] = static_cast<std::uint8_t>(e % 5 == 0 ? 255 : e * 89 % 256);
    return image;
}
std::vector<float> running(const std::vector<std::uint8_t>& image, const photograph_preprocessing& form) {
    std::vector<float> to(large.size());
    to_photograph(image, {grey.rows, grey.columns}, form, {large.rows, large.columns}, to);
    return to;
}
std::vector<float> fixed(const std::vector<std::uint8_t>& image, const photograph_preprocessing& form) {
    std::vector<float> to(large.size());
    to_photograph(tensor_view<const std::uint8_t, grey>(image.data()), form,
                  tensor_view<float, large>(to.data()));
    return to;
}

TEST_CASE("photograph: every channel is the resized image, normalised") {
    const auto image = touch();
    for (const resized_pixel pixel : {resized_pixel::count, resized_pixel::number}) {
        photograph_preprocessing form = mean_photograph(123, 117, 104);
        form.normalise.scale = {1, 0.5F, 2};
        form.pixel = pixel;
        std::vector<float> found(large.size()), resized(large.area());
        to_photograph(tensor_view<const std::uint8_t, grey>(image.data()), form,
                      tensor_view<float, large>(found.data()));
        constexpr shape one{large.rows, large.columns};
        resize<grey, one>(tensor_view<const std::uint8_t, grey>(image.data()),
                          tensor_view<float, one>(resized.data()));
        bool overshoots = false;
        for (std::size_t channel = 0; channel < 3; ++channel)
            for (std::size_t e = 0; e < one.size(); ++e) {
                overshoots = overshoots || resized[e] > 255 || resized[e] < 0;
                const float value = pixel == resized_pixel::count
                                        ? static_cast<float>(saturate_to_count(resized[e]))
                                        : resized[e];
                CAPTURE(e);
                REQUIRE(found[channel * one.size() + e] ==
                        (value - form.normalise.mean[channel]) * form.normalise.scale[channel]);
            }
        CHECK(overshoots);
    }
}

TEST_CASE("photograph: torchvision's normalisation of black and white") {
    // (0 − mean) ÷ deviation and (1 − mean) ÷ deviation, of values 0 … 1.
    constexpr std::array<double, 3> mean{0.485, 0.456, 0.406}, deviation{0.229, 0.224, 0.225};
    std::array<std::uint8_t, grey.size()> image{};
    std::vector<float> found(large.size());
    for (const int count : {0, 255}) {
        image.fill(static_cast<std::uint8_t>(count));
        to_photograph(tensor_view<const std::uint8_t, grey>(image.data()), torchvision_photograph,
                      tensor_view<float, large>(found.data()));
        for (std::size_t channel = 0; channel < 3; ++channel)
            // A few roundings of numbers up to 255 ÷ (0.224 · 255).
            CHECK(std::abs(static_cast<double>(found[channel * large.area() + 7]) -
                           (count / 255.0 - mean[channel]) / deviation[channel]) < 8 * 0x1p-24 / 0.224);
    }
}

TEST_CASE("photograph: sizes known at run time, as the photograph between sizes that are constants") {
    const auto image = touch();
    photograph_preprocessing form{{.mean = {1, 2, 3}, .scale = {1, 0.5F, 2}}, resized_pixel::number};
    auto found = running(image, form), expected = fixed(image, form);
    // A pixel is a sum of 16 products, whose weights add up to less than 2 in magnitude; then one difference
    // and one product.
    constexpr double bound = 20 * 2 * 255 * 2 * std::numeric_limits<float>::epsilon();
    for (std::size_t e = 0; e < found.size(); ++e)
        REQUIRE(std::abs(found[e] - expected[e]) <= bound);

    form.pixel = resized_pixel::count;
    found = running(image, form), expected = fixed(image, form);
    const auto exact = running(image, {{}, resized_pixel::number});
    for (std::size_t e = 0; e < found.size(); ++e) {
        const double value = static_cast<double>(exact[e]), half = value - std::floor(value) - 0.5;
        const float scale = form.normalise.scale[e / large.area()];
        // Half-way between two counts either may be right.
        REQUIRE(std::abs(found[e] - expected[e]) <= (std::abs(half) < bound ? scale : 0));
    }
}

TEST_CASE(
    "photograph: sizes known at run time, images and photographs that are not as long as they should be") {
    const auto image = touch();
    std::vector<float> to(large.size() + 1);
    CHECK_THROWS_AS(to_photograph(image, {9, 14}, torchvision_photograph, {31, 27}, to),
                    std::invalid_argument);
    to.resize(large.size());
    CHECK_THROWS_AS(to_photograph(image, {9, 13}, torchvision_photograph, {31, 27}, to),
                    std::invalid_argument);
    CHECK_THROWS_AS(to_photograph(std::vector<std::uint8_t>{}, {0, 0}, torchvision_photograph, {31, 27}, to),
                    std::invalid_argument);
}

constexpr shape small_grey{6, 9};
using trunk = network<shape{12, 14, 3}, conv2d<8, 3, 2>, relu, conv2d<6, 1>, relu>;
using extractor = feature_extractor<trunk, small_grey>;

trunk seeded_trunk() {
    trunk n;
    float next = 0.37F;
    n.for_each_parameter([&](const parameter&, std::span<float> values) {
        for (float& value : values)
            value = 0.2F * ((next = next * 1.7F + 0.11F) > 1 ? next -= 1 : next) - 0.07F;
    });
    return n;
}
std::vector<std::uint8_t> small_images(std::size_t count) {
    std::vector<std::uint8_t> pixels(count * small_grey.size());
    for (std::size_t e = 0; e < pixels.size(); ++e)
        pixels[e] = static_cast<std::uint8_t>(e * e % 251);
    return pixels;
}

TEST_CASE("feature_extractor: what the trunk gives for the photograph of an image") {
    const trunk weights = seeded_trunk();
    const photograph_preprocessing form = mean_photograph(100, 90, 80);
    const auto pixels = small_images(5);
    const std::vector<std::size_t> chosen{4, 0, 2};
    thread_pool threads(2);
    const std::vector<float> all = extractor(weights, form).rows(pixels, chosen, threads);
    constexpr shape map = extractor::map;
    REQUIRE(map == shape{6, 7, 6});
    REQUIRE(all.size() == 3 * map.size());
    const auto largest = extractor(weights, form, feature_pooling::maximum).rows(pixels, chosen, threads);
    REQUIRE(largest.size() == 3 * map.channels);

    const auto alone = deploy(weights);
    bool some = false;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        std::vector<float> picture(trunk::input_shape.size()), expected(map.size());
        to_photograph(
            tensor_view<const std::uint8_t, small_grey>(pixels.data() + chosen[i] * small_grey.size()), form,
            tensor_view<float, trunk::input_shape>(picture.data()));
        REQUIRE(alone.infer(tensor_view<const float, trunk::input_shape>(picture.data()),
                            std::span<float, map.size()>(expected)) == frame_status::ok);
        for (std::size_t e = 0; e < map.size(); ++e) {
            REQUIRE(all[i * map.size() + e] == expected[e]);
            some = some || expected[e] > 0;
        }
        for (std::size_t channel = 0; channel < map.channels; ++channel) {
            std::vector<float> row(map.channels);
            pool_features(feature_pooling::maximum, expected, map, row);
            REQUIRE(largest[i * map.channels + channel] == row[channel]);
        }
    }
    CHECK(some);
}

TEST_CASE("feature_extractor: bit-exact on any number of threads") {
    const extractor extract(seeded_trunk(), torchvision_photograph);
    const auto pixels = small_images(7);
    const std::vector<std::size_t> chosen{0, 1, 2, 3, 4, 5, 6};
    thread_pool one, three(3);
    CHECK(extract.rows(pixels, chosen, one) == extract.rows(pixels, chosen, three));
}

TEST_CASE("feature_extractor: images that are not there, and weights that give no numbers") {
    const extractor extract(seeded_trunk(), torchvision_photograph);
    const auto pixels = small_images(2);
    thread_pool threads;
    const std::vector<std::size_t> third{2}, first{0};
    CHECK_THROWS_WITH_AS(static_cast<void>(extract.rows(pixels, third, threads)),
                         "feature_extractor: expected an image among 2, found 2", std::invalid_argument);
    CHECK_THROWS_WITH_AS(static_cast<void>(extract.rows(std::span(pixels).first(60), first, threads)),
                         "feature_extractor: expected images of 54 counts, found 60 counts",
                         std::invalid_argument);
    trunk huge;
    huge.for_each_parameter([](const parameter&, std::span<float> values) {
        for (float& value : values)
            value = 1e29F;
    });
    CHECK_THROWS_AS(static_cast<void>(extractor(huge, torchvision_photograph).rows(pixels, first, threads)),
                    std::runtime_error);
}

TEST_CASE("feature_pooling: all, the largest and the mean of each channel") {
    constexpr shape map{2, 2, 3};
    static_assert(feature_count(feature_pooling::none, map) == 12);
    static_assert(feature_count(feature_pooling::maximum, map) == 3);
    static_assert(feature_count(feature_pooling::average, map) == 3);
    const std::array<float, 12> values{1, 2, 3, 4, -1, -2, -3, -4, 0, 0, 8, 0};
    const auto features = [&](feature_pooling pooling) {
        std::vector<float> result(feature_count(pooling, map));
        pool_features(pooling, values, map, result);
        return result;
    };
    CHECK(features(feature_pooling::none) == std::vector<float>(values.begin(), values.end()));
    CHECK(features(feature_pooling::maximum) == std::vector<float>{4, -1, 8});
    CHECK(features(feature_pooling::average) == std::vector<float>{2.5F, -2.5F, 2});
}

TEST_CASE("feature_pooling: a number for each channel, and none more") {
    const std::vector<float> values{1, 2, 3, 4, 50, 60}; // two channels of two pixels, and what lies behind
    for (const feature_pooling pooling : {feature_pooling::maximum, feature_pooling::average}) {
        std::vector<float> result(6, -9.0F);
        pool_features(pooling, values, shape{1, 2, 2}, result);
        CHECK(result[0] > 0);
        CHECK(result[1] > 0);
        CHECK(result[2] == -9);
    }
}

} // namespace
