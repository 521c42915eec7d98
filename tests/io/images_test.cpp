#include <tactnet/io/images/folder.hpp>
#include <tactnet/io/images/set.hpp>
#include <tactnet/io/read_file.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <support/error_of.hpp>
#include <support/files/data_folder.hpp>
#include <support/files/temporary_folder.hpp>
#include <support/files/touch.hpp>
#include <vector>

#if defined(__unix__) || defined(__APPLE__)
#include <sys/stat.h>
#endif

namespace {

using support::touch;
using tactnet::file_error;
using tactnet::list_image_folder;
using tactnet::natural_less;

std::string error_of(const std::filesystem::path& root) {
    return support::error_of<file_error>([&] { list_image_folder(root); });
}

TEST_CASE("image_folder: classes by their bytes, files in natural order, everything else passed over") {
    const support::temporary_folder folder;
    for (const char* name : {"b/b10.jpg", "b/b2.JPG", "b/b1.jpeg", "a/x.png", "C/q.PnG", "b/notes.txt",
                             "b/.b0.jpg", "b/inner/b3.jpg", "readme.jpg", ".hidden/x.jpg", "b/noextension"})
        touch(folder / name);
    const auto listed = list_image_folder(folder.path());
    CHECK(listed.root == folder.path());
    CHECK(listed.classes == std::vector<std::string>{"C", "a", "b"});
    std::vector<std::string> names;
    for (const auto& [path, label] : listed.files) {
        CHECK(path.parent_path().filename().string() == listed.classes.at(label));
        names.push_back(path.filename().string());
    }
    CHECK(names == std::vector<std::string>{"q.PnG", "x.png", "b1.jpeg", "b2.JPG", "b10.jpg"});
    CHECK(listed.left_out == std::vector<std::string>{".hidden"});

    constexpr std::array<std::string_view, 1> only_text{".txt"};
    CHECK_THROWS_AS(list_image_folder(folder.path(), only_text), file_error);
}

TEST_CASE("image_folder: images in a folder for each group of a class") {
    const support::temporary_folder folder;
    for (const char* name : {"key/s10/1.png", "key/s2/2.png", "key/s2/10.png", "key/0.png", "pen/s2/1.png"})
        touch(folder / name);
    const auto list = [&] {
        return list_image_folder(folder.path(), tactnet::default_image_extensions,
                                 tactnet::image_folder_layout::groups_in_classes);
    };
    std::vector<std::string> names;
    for (const auto& [path, label] : list().files)
        names.push_back(path.lexically_relative(folder.path()).generic_string());
    CHECK(names ==
          std::vector<std::string>{"key/s2/2.png", "key/s2/10.png", "key/s10/1.png", "pen/s2/1.png"});
    touch(folder / "box/1.png");
    CHECK(support::error_of<file_error>(list) ==
          (folder / "box").string() +
              ": expected a folder for each group of images of this class, found none");
}

TEST_CASE("image_folder: a folder that is no set of images: each error has its message") {
    const support::temporary_folder folder;
    const auto root = folder / "root";
    const std::string name = root.string();
    CHECK(error_of(root) ==
          name + ": expected a folder with one subfolder a class, found nothing of that name");
    touch(root);
    CHECK(error_of(root) == name + ": expected a folder with one subfolder a class, found a file");
    std::filesystem::remove(root);
    std::filesystem::create_directory(root);
    CHECK(error_of(root) == name + ": expected one subfolder a class, found an empty folder");
    touch(root / "a.jpg");
    touch(root / "b.jpg");
    CHECK(error_of(root) == name + ": expected one subfolder a class, found 2 files and no subfolder");
    touch(root / "key" / "1.jpg");
    CHECK(error_of(root) == name + ": expected at least two classes, a subfolder each, found only 'key'");
    std::filesystem::create_directory(root / "pen");
    CHECK(error_of(root) ==
          (root / "pen").string() +
              ": expected at least one image (.jpg, .jpeg, .png) for this class, found an empty folder");
    touch(root / "pen" / "1.gif");
    CHECK(error_of(root) == (root / "pen").string() + ": expected at least one image (.jpg, .jpeg, .png) "
                                                      "for this class, found none among 1 entries");
    touch(root / "pen" / "1.png");
    CHECK(error_of(root) == "no error");
#if defined(__linux__)
    touch(root / "caf\xE9" / "1.png");
    CHECK(error_of(root) == name + ": subfolder 'caf\\xe9': expected a name in UTF-8, found other bytes");
#endif
}

#if defined(__unix__) || defined(__APPLE__)
TEST_CASE("image_folder: links are followed, links to nothing are errors") {
    const support::temporary_folder folder;
    const auto root = folder / "root";
    touch(folder / "elsewhere" / "pens" / "1.png");
    touch(folder / "elsewhere" / "2.png");
    touch(root / "key" / "1.png");
    std::filesystem::create_directory_symlink(folder / "elsewhere" / "pens", root / "pen");
    std::filesystem::create_symlink("../../elsewhere/2.png", root / "key" / "2.png");
    const auto listed = list_image_folder(root);
    CHECK(listed.classes == std::vector<std::string>{"key", "pen"});
    CHECK(listed.files.size() == 3);

    std::filesystem::create_symlink("gone", root / "key" / "notes.txt"); // would be passed over in any case
    std::filesystem::create_symlink("gone", root / ".hidden");
    CHECK(error_of(root) == "no error");
    std::filesystem::create_symlink("gone/tube", root / "tube");
    CHECK(error_of(root) == (root / "tube").string() +
                                ": expected a link to something that is there, found one to 'gone/tube'");
    std::filesystem::remove(root / "tube");
    std::filesystem::create_symlink("gone", root / "key" / "3.png");
    CHECK(error_of(root) == (root / "key" / "3.png").string() +
                                ": expected a link to something that is there, found one to 'gone'");
    std::filesystem::remove(root / "key" / "3.png");
    std::filesystem::create_symlink("circle", root / "circle");
    CHECK(error_of(root).starts_with((root / "circle").string() + ": expected a folder or a file, found '"));
}

TEST_CASE("image_folder: pipes, sockets and devices are no images") {
    const support::temporary_folder folder;
    touch(folder / "key" / "1.png");
    touch(folder / "pen" / "1.png");
    REQUIRE(mkfifo((folder / "pen" / "pipe").c_str(), 0600) == 0);
    REQUIRE(mkfifo((folder / "pipe.png").c_str(), 0600) == 0);
    CHECK(error_of(folder.path()) == "no error"); // no program would open them
    REQUIRE(mkfifo((folder / "pen" / "2.png").c_str(), 0600) == 0);
    CHECK(error_of(folder.path()) ==
          (folder / "pen" / "2.png").string() + ": expected a regular file, found a named pipe");
    std::filesystem::remove(folder / "pen" / "2.png");
    std::filesystem::create_symlink("/dev/zero", folder / "pen" / "2.png");
    CHECK(error_of(folder.path()) ==
          (folder / "pen" / "2.png").string() + ": expected a regular file, found a device");
}
#endif

TEST_CASE("image_folder: the real recordings" * doctest::test_suite("data")) {
    const auto root = support::find_data("tactile_images");
    if (!root)
        return;
    const auto listed = list_image_folder(*root);
    CHECK(listed.classes.size() == 22);
    CHECK(listed.classes.front() == "adhesive");
    CHECK(listed.classes.back() == "tube");
    REQUIRE(listed.files.size() == 1100);
    for (std::size_t i = 0; i < listed.files.size(); ++i) {
        CHECK(listed.files[i].label == i / 50);
        const std::string number = std::to_string(i % 50 + 1) + ".jpg";
        CHECK(listed.files[i].path.filename().string().ends_with(number));
    }
}

TEST_CASE("natural_less: runs of digits count as numbers") {
    // Each comes before all that follow it, and after none.
    std::istringstream words(
        "0 00 01 1 2 010 10 a a0 a1 a1b a2 a2a a2b1 a2b10 a10 a10.jpg b key key1.jpg key02.jpg key2.jpg "
        "key10.jpg key99999999999999999999998.jpg key99999999999999999999999.jpg "
        "key100000000000000000000000.jpg key_1 \xC3\xA9");
    std::vector<std::string> ordered{""};
    ordered.insert(ordered.end(), std::istream_iterator<std::string>(words), {});
    for (std::size_t i = 0; i < ordered.size(); ++i)
        for (std::size_t j = 0; j < ordered.size(); ++j) {
            CAPTURE(ordered[i]);
            CAPTURE(ordered[j]);
            CHECK(natural_less(ordered[i], ordered[j]) == (i < j));
        }
    // Leading zeros decide only between numbers that are otherwise the same.
    CHECK(natural_less("a01b", "a1c"));
    CHECK(natural_less("a01", "a1"));
    CHECK_FALSE(natural_less("a1", "a01"));
    CHECK(natural_less("a1b", "a01c"));
    CHECK(natural_less("1", "02"));
}

/// Stands for a decoder: the file's first two characters are rows and columns, each pixel the third.
tactnet::grey_image decode_digits(const std::filesystem::path& path) {
    const auto bytes = tactnet::read_file(path);
    const auto digit = [&](std::size_t i) { return static_cast<std::size_t>(bytes.at(i)) - '0'; };
    return {digit(0), digit(1),
            std::vector<std::uint8_t>(digit(0) * digit(1), static_cast<std::uint8_t>(digit(2)))};
}

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
        CHECK(support::error_of<file_error>([&] { tactnet::load_images(mixed, 2, 3, decode_digits); }) ==
              (folder / "b" / "2.jpg").string() +
                  ": expected 2 x 3 pixels (rows x columns), found 3 x 2 pixels (rows x columns)");
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

} // namespace
