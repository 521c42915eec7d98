#include <tactnet/image/augmentation.hpp>
#include <tactnet/image/transform.hpp>
#include <tactnet/runtime/thread_pool.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <support/tolerance.hpp>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape size{7, 13, 2};
using counts = std::array<std::uint8_t, size.size()>;

counts draw_counts() {
    random_stream random(1, random_purposes::order);
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
TEST_CASE("transform_image: translation by whole tactels, filled with zeros") {
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
TEST_CASE("transform_image: almost half a turn is almost both reflections") {
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

namespace {

/// The pixel at a place within or beyond an image.
template <border_mode Border, shape Shape>
double pixel(const tensor<float, Shape>& image, int row, int column) {
    const int rows = static_cast<int>(Shape.rows), columns = static_cast<int>(Shape.columns);
    if (Border == border_mode::edge)
        row = std::clamp(row, 0, rows - 1), column = std::clamp(column, 0, columns - 1);
    if (row < 0 || row >= rows || column < 0 || column >= columns)
        return 0;
    return static_cast<double>(image(static_cast<std::size_t>(row), static_cast<std::size_t>(column)));
}
/// Weights of the pixels from floor(x) − 1 on, and how fast they change at most.
std::array<double, 4> weights_of(interpolation_mode kind, double t) {
    if (kind == interpolation_mode::bilinear)
        return {0, 1 - t, t, 0};
    const auto keys = [](double x) {
        return x <= 1 ? (1.5 * x - 2.5) * x * x + 1 : ((-0.5 * x + 2.5) * x - 4) * x + 2;
    };
    return {keys(1 + t), keys(t), keys(1 - t), keys(2 - t)};
}

/// A transform in double precision. An output may be off by the rounding of its sums and by what positions
/// are off by: three roundings of numbers no larger than the image and what was added to it; weights change
/// by no more than 1.5 a pixel.
template <shape Shape, interpolation_mode Interpolation, border_mode Border>
void check_against_reference(const image_transform& t, const tensor<float, Shape>& image) {
    tensor<float, Shape> to;
    transform_image<Shape, Interpolation, Border>(t, image.view(), to.view());
    double largest = 0;
    for (const float value : image)
        largest = std::max(largest, std::abs(static_cast<double>(value * static_cast<float>(t.gain))));
    const double u = support::unit_roundoff<float>,
                 span = static_cast<double>(Shape.rows + Shape.columns) + 8,
                 bound = (support::accumulated(u, 30) * 2 + support::accumulated(u, 3) * span * 1.5 * 8) *
                         largest;
    std::size_t wrong = 0;
    for (std::size_t y = 0; y < Shape.rows; ++y)
        for (std::size_t x = 0; x < Shape.columns; ++x) {
            const double middle_row = (static_cast<double>(Shape.rows) - 1) / 2,
                         middle_column = (static_cast<double>(Shape.columns) - 1) / 2;
            const double v = static_cast<double>(y) - middle_row, h = static_cast<double>(x) - middle_column;
            const double row = t.row_by_row * v + t.row_by_column * h + t.row_shift + middle_row,
                         column =
                             t.column_by_row * v + t.column_by_column * h + t.column_shift + middle_column;
            const double top = std::floor(row), left = std::floor(column);
            const auto down = weights_of(Interpolation, row - top),
                       along = weights_of(Interpolation, column - left);
            double sum = 0;
            for (int i = 0; i < 4; ++i)
                for (int j = 0; j < 4; ++j)
                    sum +=
                        down[static_cast<std::size_t>(i)] * along[static_cast<std::size_t>(j)] *
                        pixel<Border>(image, static_cast<int>(top) - 1 + i, static_cast<int>(left) - 1 + j) *
                        t.gain;
            wrong += !support::within(static_cast<double>(to(y, x)), {sum, bound});
        }
    CHECK_MESSAGE(wrong == 0, Shape.rows << " x " << Shape.columns);
}
template <shape Shape>
void check_drawn(std::uint32_t count) {
    random_stream random(5, random_purposes::augmentation);
    tensor<float, Shape> image;
    for (float& value : image)
        value = static_cast<float>(random.uniform(-50, 255));
    for (std::uint32_t i = 0; i < count; ++i) {
        const augmentation_ranges wild{0.5, 0.5, 6, 180, 0.5, 0.5, 0.3};
        const image_transform t = image_transform::draw(wild, random);
        check_against_reference<Shape, interpolation_mode::bilinear, border_mode::zero>(t, image);
        check_against_reference<Shape, interpolation_mode::bilinear, border_mode::edge>(t, image);
        check_against_reference<Shape, interpolation_mode::bicubic, border_mode::zero>(t, image);
        check_against_reference<Shape, interpolation_mode::bicubic, border_mode::edge>(t, image);
    }
}

/// With each interpolation and fill, to the bit, whatever the image.
template <shape Shape, class Where>
void check_permutation(const image_motion& motion, Where&& where) {
    tensor<float, Shape> image, to;
    random_stream random(6, random_purposes::augmentation);
    for (float& value : image)
        value = static_cast<float>(random.uniform(-50, 255));
    image(0, 0) = -0.0f;
    image(Shape.rows - 1, Shape.columns / 2) = std::numeric_limits<float>::infinity();
    image(Shape.rows / 2, 0) = std::numeric_limits<float>::quiet_NaN();
    const auto check = [&] {
        for (std::size_t y = 0; y < Shape.rows; ++y)
            for (std::size_t x = 0; x < Shape.columns; ++x) {
                const auto [row, column] = where(y, x);
                CHECK(std::bit_cast<std::uint32_t>(to(y, x)) ==
                      std::bit_cast<std::uint32_t>(image(row, column)));
            }
    };
    const image_transform t = image_transform::of(motion);
    transform_image<Shape>(t, image.view(), to.view());
    check();
    transform_image<Shape, interpolation_mode::bicubic>(t, image.view(), to.view());
    check();
    transform_image<Shape, interpolation_mode::bilinear, border_mode::edge>(t, image.view(), to.view());
    check();
    transform_image<Shape, interpolation_mode::bicubic, border_mode::edge>(t, image.view(), to.view());
    check();
}
template <shape Shape>
void check_permutations() {
    constexpr std::size_t bottom = Shape.rows - 1, right = Shape.columns - 1;
    using at = std::array<std::size_t, 2>;
    check_permutation<Shape>({}, [](std::size_t y, std::size_t x) { return at{y, x}; });
    check_permutation<Shape>({.reflect_rows = true}, [](std::size_t y, std::size_t x) {
        return at{bottom - y, x};
    });
    check_permutation<Shape>({.reflect_columns = true}, [](std::size_t y, std::size_t x) {
        return at{y, right - x};
    });
    for (const double half : {180.0, -180.0, 540.0})
        check_permutation<Shape>({.rotation = half}, [](std::size_t y, std::size_t x) {
            return at{bottom - y, right - x};
        });
    if constexpr (Shape.rows == Shape.columns) {
        // From down to the right: what was on the left comes to the bottom.
        for (const double quarter : {90.0, -270.0})
            check_permutation<Shape>({.rotation = quarter}, [](std::size_t y, std::size_t x) {
                return at{x, bottom - y};
            });
        for (const double quarter : {-90.0, 270.0})
            check_permutation<Shape>({.rotation = quarter}, [](std::size_t y, std::size_t x) {
                return at{right - x, y};
            });
    }
}

} // namespace

TEST_CASE("transform_image: any motion, interpolation and fill against double precision") {
    check_drawn<shape{28, 50}>(20);
    check_drawn<shape{7, 13}>(20);
    check_drawn<shape{33, 32}>(5);
    check_drawn<shape{1, 9}>(20);
    check_drawn<shape{9, 1}>(20);
    check_drawn<shape{2, 3}>(20);
    check_drawn<shape{1, 1}>(20);
}
TEST_CASE("transform_image: what moves pixels to pixels changes none of their bits") {
    check_permutations<shape{28, 50}>();
    check_permutations<shape{7, 13}>();
    check_permutations<shape{8, 8}>();
    check_permutations<shape{5, 5}>();
    check_permutations<shape{1, 6}>();
    check_permutations<shape{6, 1}>();
    check_permutations<shape{1, 1}>();
}
TEST_CASE("transform_image: edge fill repeats the border beyond the image") {
    tensor<float, shape{3, 4}> image, to;
    for (std::size_t e = 0; e < image.size(); ++e)
        image.data()[e] = static_cast<float>(e + 1);
    transform_image<shape{3, 4}, interpolation_mode::bicubic, border_mode::edge>(
        {.row_shift = -40, .column_shift = 40}, image.view(), to.view());
    CHECK(std::all_of(to.begin(), to.end(), [](float v) { return v == 4; }));
}
TEST_CASE("transform_image: NaN reaches the outputs that weigh it") {
    tensor<float, shape{9, 11}> image, to;
    image(4, 5) = std::numeric_limits<float>::quiet_NaN();
    transform_image<shape{9, 11}>({.column_shift = 0.25}, image.view(), to.view());
    for (std::size_t y = 0; y < 9; ++y)
        for (std::size_t x = 0; x < 11; ++x)
            CHECK(std::isnan(to(y, x)) == (y == 4 && (x == 4 || x == 5)));
}
TEST_CASE("transform_image: a map that is not a number is no crash") {
    tensor<float, shape{9, 11}> image, to;
    const double broken = std::numeric_limits<double>::quiet_NaN();
    transform_image<shape{9, 11}>({.row_by_column = broken, .column_shift = broken}, image.view(), to.view());
    CHECK(std::all_of(to.begin(), to.end(), [](float v) { return v == 0; }));
}
TEST_CASE("transform_image: a map that collapses the image repeats its middle, one to infinity gives zeros") {
    const counts from = draw_counts();
    const auto all_are = [&](const image_transform& map, float value) {
        const tensor<float, size> to = transformed(map, from);
        for (std::size_t i = 0; i < size.area(); ++i)
            CHECK(to(i / size.columns, i % size.columns) == value);
    };
    const float middle = count_at(from, 3, 6, 0);
    all_are({.row_by_row = 0, .row_by_column = 0, .column_by_row = 0, .column_by_column = 0}, middle);
    all_are({.row_by_row = 0, .row_shift = 1e30, .column_by_column = 0}, 0);
    all_are({.row_by_row = 0, .row_shift = -std::numeric_limits<double>::infinity(), .column_by_column = 0},
            0);
    all_are({.row_by_row = 0, .column_by_column = 0, .column_shift = 1e300}, 0);
    all_are({.gain = 0}, 0);
}
TEST_CASE("transform_image: the same bits on any number of threads, and in place") {
    constexpr shape sensor{28, 50};
    constexpr std::size_t count = 50;
    const auto all = [&](std::size_t threads) {
        std::vector<tensor<float, sensor>> images(count);
        thread_pool(threads).for_each(count, [&](std::size_t i) {
            random_stream random(1, random_purposes::augmentation, 7, static_cast<std::uint32_t>(i));
            for (float& value : images[i])
                value = static_cast<float>(random.uniform(0, 255));
            const image_transform t = image_transform::draw({0.5, 0.5, 4, 15, 0.1, 0.3, 0.1}, random);
            if (threads == 1) {
                const auto from = images[i];
                transform_image<sensor>(t, from.view(), images[i].view());
            } else {
                transform_image<sensor>(t, images[i].view(), images[i].view());
            }
        });
        return images;
    };
    const auto one = all(1), three = all(3);
    for (std::size_t i = 0; i < count; ++i)
        CHECK(std::equal(one[i].begin(), one[i].end(), three[i].begin()));
}

TEST_CASE("transform_image: an erased part has no contact, in every channel; all else is as without it") {
    constexpr shape small{8, 10, 2};
    tensor<float, small> image, without, with;
    random_stream random(7, random_purposes::augmentation);
    for (float& value : image)
        value = static_cast<float>(random.uniform(1, 255));
    const auto erase = [&](image_part part) {
        image_transform t = image_transform::of({.rotation = 7, .pressure = 1.25});
        transform_image<small, interpolation_mode::bilinear, border_mode::edge>(t, image.view(),
                                                                                without.view());
        t.erased = part;
        transform_image<small, interpolation_mode::bilinear, border_mode::edge>(t, image.view(), with.view());
        std::size_t zeros = 0, changed = 0;
        for (std::size_t channel = 0; channel < small.channels; ++channel)
            for (std::size_t y = 0; y < small.rows; ++y)
                for (std::size_t x = 0; x < small.columns; ++x) {
                    const bool inside = y >= 2 && y < 4 && x >= 5 && x < 10;
                    const float here = with(y, x, channel);
                    zeros += here == 0;
                    changed += !inside && here != without(y, x, channel);
                }
        return std::array{zeros, changed};
    };
    CHECK(erase({.row = 0.25, .column = 0.5, .rows = 0.25, .columns = 0.5}) ==
          std::array<std::size_t, 2>{20, 0});
    CHECK(erase({.row = 0.21, .column = 0.46, .rows = 0.25, .columns = 9}) ==
          std::array<std::size_t, 2>{20, 0}); // whole pixels, inside the image
    CHECK(erase({}) == std::array<std::size_t, 2>{0, 0});
    CHECK(erase({.rows = 1, .columns = 0.01}) == std::array<std::size_t, 2>{0, 0});
}
