#include <tactnet/transfer/photograph.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape grey{7, 5}, large{13, 11, 3};

std::array<std::uint8_t, grey.size()> touch() {
    std::array<std::uint8_t, grey.size()> image{};
    for (std::size_t e = 0; e < image.size(); ++e)
        image[e] = static_cast<std::uint8_t>(e % 4 == 0 ? 255 : 3 * e);
    return image;
}

} // namespace

TEST_CASE("photograph: every channel is the resized image, normalised") {
    const auto image = touch();
    for (const resized_pixel pixel : {resized_pixel::count, resized_pixel::number}) {
        photograph_preprocessing form = mean_photograph(123, 117, 104);
        form.normalise.scale = {1, 0.5F, 2};
        form.pixel = pixel;
        std::vector<float> found(large.size()), resized(large.area());
        to_photograph(tensor_view<const std::uint8_t, grey>(image), form,
                      tensor_view<float, large>(found.data()));
        constexpr shape one{large.rows, large.columns};
        resize<grey, one>(tensor_view<const std::uint8_t, grey>(image),
                          tensor_view<float, one>(resized.data()));
        bool overshoots = false;
        for (std::size_t channel = 0; channel < 3; ++channel)
            for (std::size_t e = 0; e < one.size(); ++e) {
                overshoots = overshoots || resized[e] > 255 || resized[e] < 0;
                const float value =
                    pixel == resized_pixel::count ? static_cast<float>(to_count(resized[e])) : resized[e];
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
        to_photograph(tensor_view<const std::uint8_t, grey>(image), torchvision_photograph,
                      tensor_view<float, large>(found.data()));
        for (std::size_t channel = 0; channel < 3; ++channel)
            // A few roundings of numbers up to 255 ÷ (0.224 · 255).
            CHECK(std::abs(static_cast<double>(found[channel * large.area() + 7]) -
                           (count / 255.0 - mean[channel]) / deviation[channel]) < 8 * 0x1p-24 / 0.224);
    }
}
