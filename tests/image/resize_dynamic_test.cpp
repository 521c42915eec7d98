#include <tactnet/image/resize.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

using namespace tactnet;

using pixels = std::vector<std::uint8_t>;

TEST_CASE("keys: one at zero, zero at whole numbers, smooth in between") {
    CHECK(keys_cubic<>::weight(0) == 1);
    for (const double x : {1.0, 2.0, 2.5, -1.0, -3.0})
        CHECK(keys_cubic<>::weight(x) == doctest::Approx(0));
    CHECK(keys_cubic<>::weight(0.5) == doctest::Approx(0.5625));
    CHECK(keys_cubic<>::weight(1.5) == doctest::Approx(-0.0625));
    CHECK(keys_cubic<>::weight(-1.5) == keys_cubic<>::weight(1.5));
    for (double x = 0; x < 1; x += 0.1) // a partition of one
        CHECK(keys_cubic<>::weight(x) + keys_cubic<>::weight(x - 1) + keys_cubic<>::weight(x + 1) +
                  keys_cubic<>::weight(x - 2) ==
              doctest::Approx(1));
}

TEST_CASE("resize_bicubic: a constant image stays one, at any size") {
    for (const std::size_t rows : {1u, 2u, 7u, 28u})
        for (const std::size_t columns : {1u, 13u, 50u})
            for (const std::size_t new_rows : {1u, 3u, 28u, 40u})
                for (const std::size_t new_columns : {1u, 18u, 77u})
                    for (const std::uint8_t value : {std::uint8_t{0}, std::uint8_t{97}, std::uint8_t{255}})
                        CHECK(resize_bicubic(pixels(rows * columns, value), rows, columns, new_rows,
                                             new_columns) == pixels(new_rows * new_columns, value));
}

TEST_CASE("resize_bicubic: the same size is the same image") {
    pixels image(7 * 13);
    for (std::size_t i = 0; i < image.size(); ++i)
        image[i] = static_cast<std::uint8_t>(i * 53 % 256);
    CHECK(resize_bicubic(image, 7, 13, 7, 13) == image);
}

TEST_CASE("resize_bicubic: a ramp stays a ramp inside") {
    for (const std::size_t size : {20u, 31u, 60u}) {
        pixels ramp(30);
        for (std::size_t i = 0; i < 30; ++i)
            ramp[i] = static_cast<std::uint8_t>(6 * i + 10);
        const pixels along = resize_bicubic(ramp, 1, 30, 1, size),
                     across = resize_bicubic(ramp, 30, 1, size, 1);
        CHECK(along == across);
        const double scale = static_cast<double>(size) / 30;
        for (std::size_t o = 0; o < size; ++o) {
            const double position = (static_cast<double>(o) + 0.5) / scale - 0.5;
            if (position < 4 || position > 25)
                continue;
            CHECK(std::abs(along[o] - (6 * position + 10)) <=
                  0.5 + 0.5); // rounded; a widened support is not exactly linear
        }
    }
}

TEST_CASE("resize_bicubic: rows and columns are treated alike") {
    pixels image(8 * 5), turned(5 * 8);
    for (std::size_t y = 0; y < 8; ++y)
        for (std::size_t x = 0; x < 5; ++x)
            image[y * 5 + x] = turned[x * 8 + y] = static_cast<std::uint8_t>((y * 37 + x * 91) % 256);
    const pixels small = resize_bicubic(image, 8, 5, 4, 3), small_turned = resize_bicubic(turned, 5, 8, 3, 4);
    for (std::size_t y = 0; y < 4; ++y)
        for (std::size_t x = 0; x < 3; ++x)
            CHECK(small[y * 3 + x] == small_turned[x * 4 + y]);
}

TEST_CASE("resize_bicubic: overshoot is kept within the range") {
    pixels step(40);
    std::fill(step.begin() + 20, step.end(), std::uint8_t{255});
    const pixels wide = resize_bicubic(step, 1, 40, 1, 160);
    CHECK(std::is_sorted(wide.begin(), wide.end()));
    CHECK(wide.front() == 0);
    CHECK(wide.back() == 255);
}

TEST_CASE("resize_bicubic: refuses what is no image") {
    CHECK_THROWS_AS(static_cast<void>(resize_bicubic(pixels(6), 2, 4, 1, 1)), std::invalid_argument);
    CHECK_THROWS_AS(static_cast<void>(resize_bicubic(pixels(), 0, 0, 1, 1)), std::invalid_argument);
    CHECK_THROWS_AS(static_cast<void>(resize_bicubic(pixels(6), 2, 3, 0, 1)), std::invalid_argument);
    // Products of sizes that wrap around to what there is, or to nothing.
    constexpr std::size_t half = std::size_t{1} << (std::numeric_limits<std::size_t>::digits - 1);
    CHECK_THROWS_AS(static_cast<void>(resize_bicubic(pixels(6), half, 2, 1, 1)), std::invalid_argument);
    CHECK_THROWS_AS(static_cast<void>(resize_bicubic(pixels(6), half + 3, 2, 1, 1)), std::invalid_argument);
    for (const std::size_t size : {half, half / 2, half / 4})
        for (const std::size_t other : {1u, 2u, 8u}) {
            CHECK_THROWS_AS(static_cast<void>(resize_bicubic(pixels(6), 2, 3, size, other)),
                            std::length_error);
            CHECK_THROWS_AS(static_cast<void>(resize_bicubic(pixels(6), 2, 3, other, size)),
                            std::length_error);
        }
    CHECK(resize_bicubic(pixels(6), 2, 3, 300, 200).size() == 60'000);
}
