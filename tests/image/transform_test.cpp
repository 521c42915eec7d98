#include <tactnet/image/transform.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <support/tolerance.hpp>

using namespace tactnet;

namespace {

constexpr shape size{7, 13, 2};
using counts = std::array<std::uint8_t, size.size()>;

counts draw_counts() {
    random_stream random(1, draw::order);
    counts c;
    for (std::uint8_t& each : c)
        each = static_cast<std::uint8_t>(random.below(256));
    return c;
}
tensor<float, size> transformed(const image_transform& t, const counts& from) {
    tensor<float, size> to;
    transform_image<size>(t, from, to);
    return to;
}
float count_at(const counts& c, int row, int column, std::size_t channel) {
    if (row < 0 || row >= 7 || column < 0 || column >= 13)
        return 0;
    return c[channel * size.area() + static_cast<std::size_t>(row * 13 + column)];
}
/// Every element against where(row, column), exactly; zero outside.
template <class Where>
void check_exact(const image_transform& t, Where&& where) {
    const counts from = draw_counts();
    const tensor<float, size> to = transformed(t, from);
    for (std::size_t channel = 0; channel < 2; ++channel)
        for (int row = 0; row < 7; ++row)
            for (int column = 0; column < 13; ++column) {
                const auto [y, x] = where(row, column);
                CHECK(to(static_cast<std::size_t>(row), static_cast<std::size_t>(column), channel) ==
                      count_at(from, y, x, channel));
            }
}
using place = std::array<int, 2>;

} // namespace

TEST_CASE("transform_image: nothing done is nothing changed") {
    check_exact({}, [](int row, int column) { return place{row, column}; });
}
TEST_CASE("transform_image: reflections are permutations") {
    check_exact({.row_by_row = -1}, [](int row, int column) { return place{6 - row, column}; });
    check_exact({.column_by_column = -1}, [](int row, int column) { return place{row, 12 - column}; });
    check_exact({.row_by_row = -1, .column_by_column = -1}, [](int row, int column) {
        return place{6 - row, 12 - column};
    });
}
TEST_CASE("transform_image: translation by whole tactels, zeros behind") {
    for (const int down : {-8, -3, -1, 0, 2, 7})
        for (const int right : {-13, -2, 0, 1, 12})
            check_exact({.row_shift = -1.0 * down, .column_shift = -1.0 * right}, [&](int row, int column) {
                return place{row - down, column - right};
            });
}
TEST_CASE("transform_image: far away there is nothing") {
    const tensor<float, size> to = transformed({.row_shift = 1e6, .column_shift = -1e6}, draw_counts());
    CHECK(std::all_of(to.begin(), to.end(), [](float v) { return v == 0; }));
}
TEST_CASE("transform_image: half a tactel is the mean of two") {
    const counts from = draw_counts();
    const tensor<float, size> to = transformed({.column_shift = 0.5}, from);
    for (int row = 0; row < 7; ++row)
        for (int column = 0; column < 13; ++column)
            CHECK(to(static_cast<std::size_t>(row), static_cast<std::size_t>(column)) ==
                  (count_at(from, row, column, 0) + count_at(from, row, column + 1, 0)) / 2);
}
TEST_CASE("transform_image: gain") {
    const counts from = draw_counts();
    const tensor<float, size> to = transformed({.gain = 0.5}, from);
    CHECK(to(3, 4, 1) == count_at(from, 3, 4, 1) / 2);
}
TEST_CASE("transform_image: half a turn is both reflections") {
    const double c = std::cos(std::numbers::pi), s = std::sin(std::numbers::pi);
    const counts from = draw_counts();
    const tensor<float, size> turned =
        transformed({.row_by_row = c, .row_by_column = s, .column_by_row = -s, .column_by_column = c}, from);
    const tensor<float, size> reflected = transformed({.row_by_row = -1, .column_by_column = -1}, from);
    // A coordinate up to 13 is rounded to single precision, and two of them weigh differences of up to 255.
    const double bound = support::accumulated(support::unit_roundoff<float>, 3) * 16 * 2 * 255;
    for (std::size_t i = 0; i < size.size(); ++i)
        CHECK(support::within(static_cast<double>(turned.data()[i]),
                              {static_cast<double>(reflected.data()[i]), bound}));
}
TEST_CASE("transform_image: a quarter turn of a square turns it to the left or the right, not inside out") {
    constexpr shape square{5, 5, 1};
    std::array<std::uint8_t, 25> from{};
    from[0 * 5 + 2] = 200; // above the centre
    tensor<float, square> to;
    const double c = std::cos(std::numbers::pi / 2), s = std::sin(std::numbers::pi / 2);
    transform_image<square>({.row_by_row = c, .row_by_column = s, .column_by_row = -s, .column_by_column = c},
                            from, to);
    CHECK((to(2, 0) > 199.9f) != (to(2, 4) > 199.9f));
    float sum = 0;
    for (const float v : to)
        sum += v;
    CHECK(sum == doctest::Approx(200).epsilon(1e-4));
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
        random_stream random(1, draw::augmentation, 0, i);
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
        random_stream random(seed, draw::augmentation, epoch, sample);
        const image_transform t = image_transform::draw(ranges, random);
        return std::array{t.row_by_row,       t.row_by_column, t.row_shift, t.column_by_row,
                          t.column_by_column, t.column_shift,  t.gain};
    };
    CHECK(drawn(1, 2, 3) == drawn(1, 2, 3));
    CHECK(drawn(1, 2, 3) != drawn(2, 2, 3));
    CHECK(drawn(1, 2, 3) != drawn(1, 3, 3));
    CHECK(drawn(1, 2, 3) != drawn(1, 2, 4));
    random_stream random(1, draw::augmentation);
    const image_transform t = image_transform::draw({}, random);
    check_exact(t, [](int row, int column) { return place{row, column}; });
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
    CHECK(published(20, 35) == std::array{2.0, 3.0});
    CHECK(published(14, 25) == std::array{2.0, 3.0});
    CHECK(published(10, 18) == std::array{1.0, 2.0});
    CHECK(published(7, 13) == std::array{1.0, 2.0});
}
