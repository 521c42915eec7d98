#include <tactnet/io/read_file.hpp>
#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <support/error_of.hpp>
#include <support/files/temporary_folder.hpp>
#include <type_traits>
#include <vector>

#if defined(__linux__)
#include <csignal>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

using tactnet::file_error;
using tactnet::read_file;
using tactnet::write_file;

static_assert(std::is_nothrow_copy_constructible_v<file_error>);

namespace {

std::string text_of(const std::filesystem::path& path) {
    const auto bytes = read_file(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::ptrdiff_t entries_in(const std::filesystem::path& folder) {
    return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
}

std::string error_of(const auto& action) {
    return support::error_of<file_error>(action);
}

} // namespace

TEST_CASE("write_file: what was written is read") {
    const support::temporary_folder folder;
    for (const std::size_t size : {0U, 1U, 4096U, 3'000'000U}) {
        std::vector<std::byte> bytes(size);
        for (std::size_t i = 0; i < size; ++i)
            bytes[i] = static_cast<std::byte>(i * 31 + i / 256);
        write_file(folder / "file", bytes);
        CHECK(read_file(folder / "file") == bytes);
    }
    write_file(folder / "file", std::string_view("a\nb\r\n"));
    CHECK(text_of(folder / "file") == "a\nb\r\n");
    CHECK(entries_in(folder.path()) == 1);
}

TEST_CASE("write_file: pieces are written in order") {
    const support::temporary_folder folder;
    const std::string a = "one, ", b, c = "two";
    const std::array<std::span<const std::byte>, 3> pieces{
        std::as_bytes(std::span(a)), std::as_bytes(std::span(b)), std::as_bytes(std::span(c))};
    write_file(folder / "file", pieces);
    CHECK(text_of(folder / "file") == "one, two");
}

TEST_CASE("write_file: what gives the pieces may fail half-way: the old file stays, and no other") {
    const support::temporary_folder folder;
    write_file(folder / "file", std::string_view("old"));
    const std::vector<std::byte> piece(100'000);
    CHECK_THROWS_AS(write_file(folder / "file",
                               [&](tactnet::chunk_sink take) {
                                   take(piece);
                                   throw std::runtime_error("no more");
                               }),
                    std::runtime_error);
    CHECK(text_of(folder / "file") == "old");
    CHECK(entries_in(folder.path()) == 1);
}

TEST_CASE("write_file: a place that became a folder meanwhile is an error, and no other file stays") {
    const support::temporary_folder folder;
    CHECK_THROWS_AS(write_file(folder / "file",
                               [&](tactnet::chunk_sink take) {
                                   take(std::vector<std::byte>(10));
                                   std::filesystem::create_directories(folder / "file" / "within");
                               }),
                    file_error);
    CHECK(entries_in(folder.path()) == 1);
    CHECK(std::filesystem::is_directory(folder / "file" / "within"));
}

TEST_CASE("write_file: writing: each failure has its sentence and leaves nothing") {
    const support::temporary_folder folder;
    const std::string_view text = "text";
    CHECK(error_of([&] { write_file(folder.path(), text); }).find("found a folder") != std::string::npos);
    CHECK(error_of([&] {
              write_file(folder / "missing" / "file", text);
          }).find("missing/file: expected a folder to write in, found 'No such file or directory'") !=
          std::string::npos);
    CHECK(error_of([&] { write_file("", text); }) != "no error");
    CHECK(entries_in(folder.path()) == 0);
}

TEST_CASE("write_file: permissions of a replaced file are kept, and links are followed") {
    using std::filesystem::perms;
    const support::temporary_folder folder;
    write_file(folder / "file", std::string_view("old"));
    std::filesystem::permissions(folder / "file", perms::owner_read | perms::owner_write);
    std::filesystem::create_directory(folder / "elsewhere");
    std::filesystem::create_symlink(folder / "file", folder / "elsewhere" / "link");
    write_file(folder / "elsewhere" / "link", std::string_view("new"));
    CHECK(std::filesystem::is_symlink(folder / "elsewhere" / "link"));
    CHECK(text_of(folder / "file") == "new");
    CHECK(std::filesystem::status(folder / "file").permissions() == (perms::owner_read | perms::owner_write));
}

#if defined(__linux__)
TEST_CASE("write_file: devices are read up to the bound and written to, not replaced") {
    CHECK(error_of([] { read_file("/dev/zero", 10'000'000); }).find("at most 10000000 bytes, found more") !=
          std::string::npos);
    CHECK(error_of([] { read_file("/dev/zero"); }) ==
          "/dev/zero: expected at most 67108864 bytes, found more"); // not 2 GiB of them
    CHECK(read_file("/dev/null").empty());
    write_file("/dev/null", std::string_view("text"));
    CHECK(std::filesystem::is_character_file("/dev/null"));
    CHECK(error_of([] { write_file("/dev/full", std::string_view("text")); }) ==
          "/dev/full: expected to write all bytes, found 'No space left on device'");
}

TEST_CASE("write_file: a write that fails half-way leaves the old file and no other") {
    const support::temporary_folder folder;
    write_file(folder / "file", std::string_view("old"));
    // A bound on file sizes stands for the full disk; without the signal it is an error like any other.
    rlimit before{};
    REQUIRE(getrlimit(RLIMIT_FSIZE, &before) == 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit small = before;
    small.rlim_cur = 100'000;
    REQUIRE(setrlimit(RLIMIT_FSIZE, &small) == 0);
    const std::string error =
        error_of([&] { write_file(folder / "file", std::vector<std::byte>(1'000'000)); });
    REQUIRE(setrlimit(RLIMIT_FSIZE, &before) == 0);
    std::signal(SIGXFSZ, handler);
    CHECK(error == (folder / "file").string() + ": expected to write all bytes, found 'File too large'");
    CHECK(text_of(folder / "file") == "old");
    CHECK(entries_in(folder.path()) == 1);
}
#endif
