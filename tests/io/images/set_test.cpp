#include <tactnet/io/images/set.hpp>
#include <tactnet/io/read_file.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <support/files/temporary_folder.hpp>
#include <support/files/touch.hpp>
#include <vector>

using support::touch;
using tactnet::file_error;
using tactnet::list_image_folder;

namespace {

/// Stands for a decoder: the file's first two characters are rows and columns, each pixel the third.
tactnet::grey_image decode_digits(const std::filesystem::path& path) {
    const auto bytes = tactnet::read_file(path);
    const auto digit = [&](std::size_t i) { return static_cast<std::size_t>(bytes.at(i)) - '0'; };
    return {digit(0), digit(1),
            std::vector<std::uint8_t>(digit(0) * digit(1), static_cast<std::uint8_t>(digit(2)))};
}

} // namespace

TEST_CASE("load_images: image after image, in the order of the folder") {
    const support::temporary_folder folder;
    touch(folder / "a" / "1.jpg", "234");
    touch(folder / "a" / "2.jpg", "235");
    touch(folder / "b" / "1.jpg", "236");
    const auto listed = list_image_folder(folder.path());
    const auto set = tactnet::load_images(listed, 2, 3, decode_digits);
    CHECK(set.rows == 2);
    CHECK(set.columns == 3);
    CHECK(set.size() == 3);
    CHECK(set.labels == std::vector<std::size_t>{0, 0, 1});
    CHECK(set.classes == std::vector<std::string>{"a", "b"});
    CHECK(set.paths.at(1) == folder / "a" / "2.jpg");
    REQUIRE(set.pixels.size() == 18);
    CHECK(std::ranges::count(set.image(1), 5) == 6);
    CHECK(std::ranges::count(set.pixels, 6) == 6);

    SUBCASE("another size is an error that names the file") {
        touch(folder / "b" / "2.jpg", "327");
        const auto mixed = list_image_folder(folder.path());
        try {
            tactnet::load_images(mixed, 2, 3, decode_digits);
            FAIL("nothing was thrown");
        } catch (const file_error& error) {
            CHECK(std::string(error.what()) ==
                  (folder / "b" / "2.jpg").string() +
                      ": expected 2 x 3 pixels (rows x columns), found 3 x 2 pixels (rows x columns)");
        }
    }
    SUBCASE("unless it is to be resized") {
        touch(folder / "b" / "2.jpg", "327");
        const auto mixed = list_image_folder(folder.path());
        int calls = 0;
        const auto resized = tactnet::load_images(mixed, 2, 3, decode_digits, [&](tactnet::grey_image image) {
            ++calls;
            CHECK(image.rows == 3);
            return tactnet::grey_image{2, 3, std::vector<std::uint8_t>(6, 99)};
        });
        CHECK(calls == 1);
        CHECK(resized.size() == 4);
        CHECK(resized.image(3)[5] == 99);
    }
    SUBCASE("what a decoder throws goes through") {
        std::filesystem::remove(folder / "a" / "2.jpg");
        CHECK_THROWS_AS(tactnet::load_images(listed, 2, 3, decode_digits), file_error);
    }
    SUBCASE("a decoder that contradicts itself is a mistake of the program") {
        const auto wrong = [](const std::filesystem::path&) {
            return tactnet::grey_image{2, 3, std::vector<std::uint8_t>(5)};
        };
        CHECK_THROWS_AS(tactnet::load_images(listed, 2, 3, wrong), std::logic_error);
    }
}
