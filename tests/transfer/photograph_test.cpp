#include <tactnet/transfer/photograph.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

using namespace tactnet;

namespace {

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

} // namespace

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
