#include <tactnet/networks/normalisation.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <vector>

using namespace tactnet;

namespace {
constexpr shape size{2, 3, 1};
}

TEST_CASE("normalisation: the mean of the chosen images alone") {
    std::vector<std::uint8_t> images(3 * size.size());
    for (std::size_t i = 0; i < images.size(); ++i)
        images[i] = static_cast<std::uint8_t>(i < 6 ? i : i < 12 ? 255 : 10 * (i - 12) + 1);
    const std::vector<std::size_t> chosen{0, 2};
    const auto mean = normalisation<size>::mean_of(images, chosen);
    for (std::size_t e = 0; e < size.size(); ++e)
        CHECK(mean.data()[e] == (static_cast<float>(e) + static_cast<float>(10 * e + 1)) / 2);
    const auto none = normalisation<size>::mean_of(images, {});
    for (const float v : none)
        CHECK(v == 0);
}

TEST_CASE("normalisation: the mean of many is rounded once") {
    std::vector<std::uint8_t> images(100000 * size.size(), 255);
    std::vector<std::size_t> all(100000);
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i] = i;
    images[0] = 254;
    const auto mean = normalisation<size>::mean_of(images, all);
    CHECK(mean.data()[0] == static_cast<float>((254.0 + 255.0 * 99999) / 100000));
    CHECK(mean.data()[1] == 255);
}

TEST_CASE("normalisation: (count − mean) × scale") {
    normalisation<size> n;
    const std::array<std::uint8_t, 6> counts{0, 1, 128, 254, 255, 7};
    for (std::size_t e = 0; e < 6; ++e)
        CHECK(n.apply(counts).data()[e] == counts[e]); // as it is, to begin with
    n.scale = 1.0f / 255;
    CHECK(n.apply(counts).data()[4] == 255 * (1.0f / 255));
    n.mean.data()[3] = 0.5f;
    n.scale = 2;
    CHECK(n.apply(counts).data()[3] == 507);
    tensor<float, size> image;
    image.data()[3] = 1;
    n.apply(image);
    CHECK(image.data()[3] == 1);
}
