#include <tactnet/image/noise.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

using namespace tactnet;

namespace {

constexpr shape size{40, 50};

tensor<float, size> noisy(const pressure_noise& noise, float count, std::uint64_t seed = 1,
                          std::uint32_t epoch = 0, std::uint32_t sample = 0) {
    tensor<float, size> image;
    for (float& value : image)
        value = count;
    add_noise<size>(noise, random_stream(seed, random_purposes::noise, epoch, sample), image.view());
    return image;
}
bool equal_bits(const tensor<float, size>& a, const tensor<float, size>& b) {
    return std::equal(a.begin(), a.end(), b.begin());
}

} // namespace

TEST_CASE("add_noise: has the mean and deviation of its parameters") {
    const auto check = [](const pressure_noise& noise, double count, double deviation) {
        const auto image = noisy(noise, static_cast<float>(count));
        double sum = 0, squares = 0;
        for (const float value : image) {
            sum += static_cast<double>(value) - count;
            squares += std::pow(static_cast<double>(value) - count, 2);
        }
        constexpr double n = static_cast<double>(size.size());
        CHECK(std::abs(sum / n) < 5 * deviation / std::sqrt(n));
        // The variance of n normal numbers scatters by √(2 / n) of itself.
        CHECK(std::abs(squares / n / (deviation * deviation) - 1) < 5 * std::sqrt(2 / n));
    };
    check({.additive = 2}, 100, 2);
    check({.relative = 0.05}, 200, 10);
    check({.additive = 3, .relative = 0.04}, 100, 5);
}
TEST_CASE("add_noise: the same for the same seed, epoch and sample") {
    const pressure_noise noise{.additive = 1};
    CHECK(equal_bits(noisy(noise, 50, 1, 2, 3), noisy(noise, 50, 1, 2, 3)));
    CHECK_FALSE(equal_bits(noisy(noise, 50, 1, 2, 3), noisy(noise, 50, 2, 2, 3)));
    CHECK_FALSE(equal_bits(noisy(noise, 50, 1, 2, 3), noisy(noise, 50, 1, 1, 3)));
    CHECK_FALSE(equal_bits(noisy(noise, 50, 1, 2, 3), noisy(noise, 50, 1, 2, 4)));
}
TEST_CASE("add_noise: zero deviation leaves every bit unchanged; nothing falls below zero; NaN stays") {
    for (const float value : noisy({}, -0.0f))
        CHECK(std::signbit(value));
    bool zero = false;
    for (const float value : noisy({.additive = 5}, 1)) {
        CHECK(value >= 0);
        zero = zero || value == 0;
    }
    CHECK(zero);
    for (const float value : noisy({.additive = 5}, std::numeric_limits<float>::quiet_NaN()))
        CHECK(std::isnan(value));
}
