#include <tactnet/image/augmentation.hpp>
#include <tactnet/image/three_channels.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

namespace {

using namespace tactnet;

TEST_CASE("image_transform: a motion and then its map lead back") {
    const image_motion m{true, false, 0.25, 1.5, 30, 2, -3, 1};
    const image_transform t = image_transform::of(m);
    // Reflected, sheared, resized, turned, moved: where the pixel (1, 2) from the centre goes.
    const double row = -1, column = 2 + 0.25 * -row * -1; // a row above moves to the other side
    const double angle = std::numbers::pi / 6, c = 1.5 * std::cos(angle), s = 1.5 * std::sin(angle);
    const double to_row = c * row - s * column + 2, to_column = s * row + c * column - 3;
    CHECK(t.row_by_row * to_row + t.row_by_column * to_column + t.row_shift == doctest::Approx(1));
    CHECK(t.column_by_row * to_row + t.column_by_column * to_column + t.column_shift == doctest::Approx(2));
}

TEST_CASE("image_transform::draw: within the ranges, reaching near their ends") {
    augmentation_ranges ranges{.reflect_rows = 0.5,
                               .reflect_columns = 0.25,
                               .translation = 3,
                               .rotation = 10,
                               .scale = 0.2,
                               .pressure = 0.5};
    double angle = 0, zoom_low = 9, zoom_high = 0, shift = 0, gain_low = 9, gain_high = 0;
    int upside_down = 0, exchanged = 0;
    constexpr int n = 4000;
    for (std::uint32_t i = 0; i < n; ++i) {
        random_stream random(1, random_purposes::augmentation, 0, i);
        const image_transform t = image_transform::draw(ranges, random);
        // The map back has the determinant ± 1 / zoom².
        const double determinant = t.row_by_row * t.column_by_column - t.row_by_column * t.column_by_row;
        const double zoom = 1 / std::sqrt(std::abs(determinant));
        zoom_low = std::min(zoom_low, zoom), zoom_high = std::max(zoom_high, zoom);
        angle = std::max(angle, std::abs(std::atan2(t.row_by_column, t.row_by_row)) < 1.6
                                    ? std::abs(std::atan2(t.row_by_column, t.row_by_row))
                                    : std::numbers::pi - std::abs(std::atan2(t.row_by_column, t.row_by_row)));
        upside_down += t.row_by_row < 0, exchanged += t.column_by_column < 0;
        gain_low = std::min(gain_low, t.gain), gain_high = std::max(gain_high, t.gain);
        // Where the centre goes: the shift that is undone by the map.
        const double row =
            -(t.column_by_column * t.row_shift - t.row_by_column * t.column_shift) / determinant;
        const double column = -(t.row_by_row * t.column_shift - t.column_by_row * t.row_shift) / determinant;
        CHECK(std::abs(row) <= 3 + 1e-12);
        CHECK(std::abs(column) <= 3 + 1e-12);
        shift = std::max({shift, std::abs(row), std::abs(column)});
    }
    CHECK(angle <= 10 * std::numbers::pi / 180 + 1e-12);
    CHECK(angle > 9.9 * std::numbers::pi / 180);
    CHECK(shift > 2.97);
    CHECK((zoom_low >= 1 / 1.2 - 1e-12 && zoom_low < 0.84 && zoom_high <= 1.2 + 1e-12 && zoom_high > 1.19));
    CHECK((gain_low >= 1 / 1.5 - 1e-12 && gain_low < 0.67 && gain_high <= 1.5 + 1e-12 && gain_high > 1.49));
    CHECK(std::abs(upside_down - n / 2) < 5 * std::sqrt(n * 0.25));
    CHECK(std::abs(exchanged - n / 4) < 5 * std::sqrt(n * 0.1875));
}

TEST_CASE(
    "image_transform::draw: the same for the same seed, epoch and sample; nothing to draw changes nothing") {
    const augmentation_ranges ranges = augmentation_ranges::published(28, 50);
    const auto drawn = [&](std::uint64_t seed, std::uint32_t epoch, std::uint32_t sample) {
        random_stream random(seed, random_purposes::augmentation, epoch, sample);
        const image_transform t = image_transform::draw(ranges, random);
        return std::array{t.row_by_row,       t.row_by_column, t.row_shift, t.column_by_row,
                          t.column_by_column, t.column_shift,  t.gain};
    };
    CHECK(drawn(1, 2, 3) == drawn(1, 2, 3));
    CHECK(drawn(1, 2, 3) != drawn(2, 2, 3));
    CHECK(drawn(1, 2, 3) != drawn(1, 3, 3));
    CHECK(drawn(1, 2, 3) != drawn(1, 2, 4));
    random_stream random(1, random_purposes::augmentation);
    const image_transform t = image_transform::draw({}, random);
    CHECK(std::array{t.row_by_row, t.column_by_column, t.gain} == std::array{1.0, 1.0, 1.0});
    CHECK(std::array{t.row_by_column, t.column_by_row, t.row_shift, t.column_shift} ==
          std::array<double, 4>{});
}

TEST_CASE("image_motion::draw: a part is erased as often as asked, with sides of a tenth to a third, inside "
          "the image") {
    const augmentation_ranges ranges{.erase = 0.25};
    int erased = 0;
    double least = 1, most = 0, farthest = 0;
    constexpr int n = 4000;
    for (std::uint32_t i = 0; i < n; ++i) {
        random_stream random(1, random_purposes::augmentation, 0, i);
        const image_part part = image_motion::draw(ranges, random).erased;
        if (part.empty())
            continue;
        ++erased;
        least = std::min({least, part.rows, part.columns}), most = std::max({most, part.rows, part.columns});
        farthest = std::max({farthest, part.row + part.rows, part.column + part.columns});
        CHECK((part.row >= 0 && part.column >= 0));
    }
    CHECK(std::abs(erased - n / 4) < 5 * std::sqrt(n * 0.1875));
    CHECK((least >= 0.1 && least < 0.102));
    CHECK((most <= 1.0 / 3 && most > 0.33));
    CHECK((farthest <= 1 + 1e-12 && farthest > 0.98));
}

TEST_CASE("augmentation_ranges: as published at the published sizes") {
    const auto published = [](std::size_t rows, std::size_t columns) {
        const augmentation_ranges r = augmentation_ranges::published(rows, columns);
        CHECK(r.reflect_rows == 0.5);
        CHECK(r.reflect_columns == 0.5);
        CHECK(r.scale == 0);
        CHECK(r.pressure == 0);
        return std::array{r.translation, r.rotation};
    };
    CHECK(published(28, 50) == std::array{3.0, 10.0});
    // A tactel more is the next ones.
    CHECK(published(11, 18) == std::array{2.0, 3.0});
    CHECK(published(10, 19) == std::array{2.0, 3.0});
    CHECK(published(21, 35) == std::array{3.0, 10.0});
    CHECK(published(20, 36) == std::array{3.0, 10.0});
    CHECK(published(20, 35) == std::array{2.0, 3.0});
    CHECK(published(14, 25) == std::array{2.0, 3.0});
    CHECK(published(10, 18) == std::array{1.0, 2.0});
    CHECK(published(7, 13) == std::array{1.0, 2.0});
}

TEST_CASE("image_motion::draw: shears to either side, as far as asked") {
    const augmentation_ranges ranges{.shear = 0.5};
    double least = 0, most = 0;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        random_stream random(1, random_purposes::augmentation, i);
        const double shear = image_motion::draw(ranges, random).shear;
        least = std::min(least, shear), most = std::max(most, shear);
    }
    CHECK(least >= -0.5);
    CHECK(least < -0.49);
    CHECK(most <= 0.5);
    CHECK(most > 0.49);
}

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

template <shape Grey>
void check() {
    tensor<float, Grey> grey;
    for (std::size_t e = 0; e < Grey.size(); ++e)
        grey.data()[e] = static_cast<float>(e) * 1.25f - 20;
    const channel_normalisation normalise{{123.68f, 116.78f, 103.94f}, {1, 0.5f, 1.0f / 57}};
    tensor<float, with_three_channels(Grey)> planar;
    std::array<float, 3 * Grey.area()> last;
    batch<float, with_three_channels(Grey), 4> samples(6);
    to_three_channels<Grey>(grey.view(), normalise, planar.view());
    to_three_channels_last<Grey>(grey.view(), normalise, last);
    to_three_channels<Grey>(grey.view(), normalise, samples.view(), 5);
    std::size_t wrong = 0;
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t e = 0; e < Grey.area(); ++e) {
            const float expected = (grey.data()[e] - normalise.mean[channel]) * normalise.scale[channel];
            wrong += planar.data()[channel * Grey.area() + e] != expected;
            wrong += last[3 * e + channel] != expected;
            wrong += samples(5, channel * Grey.area() + e) != expected;
            wrong += samples(4, channel * Grey.area() + e) != 0;
        }
    CHECK_MESSAGE(wrong == 0, Grey.rows << " x " << Grey.columns);
}

TEST_CASE("to_three_channels: the same numbers in each layout, less the mean of each channel") {
    check<shape{7, 13}>();
    check<shape{28, 50}>();
    check<shape{1, 1}>();
    check<shape{1, 3}>();
    check<shape{2, 8}>();
    check<shape{5, 5}>();
}

} // namespace
