#include <tactnet/io/read_file.hpp>
#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <support/error_of.hpp>
#include <support/files/temporary_folder.hpp>

#if defined(__linux__)
#include <sys/stat.h>
#include <unistd.h>
#endif

using tactnet::file_error;
using tactnet::read_file;
using tactnet::write_file;

namespace {

std::string text_of(const std::filesystem::path& path) {
    const auto bytes = read_file(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string error_of(const auto& action) {
    return support::error_of<file_error>(action);
}

} // namespace

TEST_CASE("read_file: each failure has its message") {
    const support::temporary_folder folder;
    const std::string missing = (folder / "missing").string();
    CHECK(error_of([&] { read_file(missing); }) == missing + ": expected a file, found nothing of that name");
    CHECK(error_of([&] { read_file(folder.path()); }) ==
          folder.path().string() + ": expected a file, found a folder");
    CHECK(error_of([&] { read_file(folder / "missing" / "file"); }).find("nothing of that name") !=
          std::string::npos);
    const auto file = folder / "file";
    write_file(file, std::string_view("12345"));
    CHECK(error_of([&] { read_file(file / "below"); }) != "no error");
    CHECK(read_file(file, 5).size() == 5);
    CHECK(error_of([&] { read_file(file, 4); }) ==
          file.string() + ": expected at most 4 bytes, found 5 bytes");
    CHECK(error_of([&] { read_file(""); }) != "no error");
}

TEST_CASE("read_file: a file is named by text of any type or by a path") {
    const support::temporary_folder folder;
    const std::filesystem::path path = folder / "näme";
    write_file(path, std::string_view("12345"));
    const std::string name = path.string();
    CHECK(read_file(path).size() == 5);
    CHECK(read_file(name).size() == 5);
    CHECK(read_file(name.c_str()).size() == 5);
    CHECK(read_file(std::string_view(name)).size() == 5);
    CHECK(tactnet::file_name(path).string() == name);
}

#if defined(__linux__)
TEST_CASE("read_file: a file that is too large is refused before it is read") {
    const support::temporary_folder folder;
    const auto file = folder / "file";
    constexpr std::size_t limit = 4'000'000;
    write_file(file, std::string_view());
    std::filesystem::resize_file(file, 10 * limit); // holes: takes no room on the disk
    // Bytes that this process has read, of whatever kind.
    const auto bytes_read = [] {
        std::ifstream counters("/proc/self/io");
        std::string name;
        std::size_t count = 0;
        counters >> name >> count;
        return count;
    };
    const std::size_t before = bytes_read();
    CHECK(error_of([&] { read_file(file, limit); }) ==
          file.string() + ": expected at most 4000000 bytes, found 40000000 bytes");
    CHECK(bytes_read() - before < limit / 2);
}

TEST_CASE(
    "read_file: a named pipe is refused, since nobody may ever write to it; one between programs is read") {
    const support::temporary_folder folder;
    const auto pipe_file = folder / "pipe", link = folder / "link";
    REQUIRE(mkfifo(pipe_file.c_str(), 0600) == 0);
    std::filesystem::create_symlink("pipe", link);
    for (const auto& path : {pipe_file, link})
        CHECK(error_of([&] { read_file(path); }) == path.string() + ": expected a file, found a named pipe");
    int ends[2] = {-1, -1};
    REQUIRE(pipe(ends) == 0);
    REQUIRE(write(ends[1], "some", 4) == 4);
    close(ends[1]);
    CHECK(text_of("/dev/fd/" + std::to_string(ends[0])) == "some");
    close(ends[0]);
}
#endif
