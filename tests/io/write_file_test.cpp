#include <tactnet/io/read_file.hpp>
#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
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
#include <thread>
#include <type_traits>
#include <vector>

#if defined(__unix__) || defined(__APPLE__)
#include <sys/wait.h>
#include <unistd.h>
#endif
#if defined(__linux__)
#include <sys/resource.h>
#include <sys/stat.h>
#endif

namespace {

using tactnet::file_error;
using tactnet::read_file;
using tactnet::write_file;

static_assert(std::is_nothrow_copy_constructible_v<file_error>);

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
    const std::filesystem::path missing = folder / "missing" / "file";
    CHECK(error_of([&] { write_file(missing, text); }) ==
          missing.string() + ": expected a folder to write in, found 'No such file or directory'");
    CHECK(error_of([&] { write_file("", text); }) != "no error");
    CHECK(entries_in(folder.path()) == 0);
}

#if defined(__unix__) || defined(__APPLE__)
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
#endif

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
    const std::filesystem::path path = folder / std::filesystem::path(u8"näme");
    write_file(path, std::string_view("12345"));
    const std::u8string text = path.u8string();
    const std::string name(text.begin(), text.end());
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

std::size_t partial_files_in(const std::filesystem::path& folder) {
    const std::filesystem::directory_iterator entries(folder);
    return static_cast<std::size_t>(std::count_if(begin(entries), end(entries), [](const auto& entry) {
        return tactnet::is_partial_file_name(entry.path().filename().string());
    }));
}

TEST_CASE("is_partial_file_name: those of write_file, and no others") {
    CHECK(tactnet::is_partial_file_name(tactnet::detail::partial_name("folder").filename().string()));
    CHECK(tactnet::is_partial_file_name(".tactnet-1-0.partial"));
    for (const char* other :
         {"", ".tactnet-.partial", ".tactnet-1.partial", ".tactnet--1.partial", ".tactnet-1-.partial",
          ".tactnet-1-2-3.partial", ".tactnet-1-a.partial", "tactnet-1-2.partial", ".tactnet-1-2.partial2",
          "x.tactnet-1-2.partial", ".tactnet-partial", "net.safetensors"})
        CHECK_MESSAGE(!tactnet::is_partial_file_name(other), other);
}

#if defined(__unix__) || defined(__APPLE__) // elsewhere files have no locks, and all stay
TEST_CASE("remove_abandoned_files: what a killed writer left goes, what is being written stays") {
    const support::temporary_folder folder;
    for (const char* name : {".tactnet-12-0.partial", ".tactnet-12-1.partial", ".tactnet-notes", "net"})
        tactnet::write_file(folder / name, "x");
    std::filesystem::create_directory(folder / ".tactnet-12-2.partial");
    CHECK(tactnet::remove_abandoned_files(folder.path()) == 2);
    CHECK(tactnet::remove_abandoned_files(folder.path()) == 0);
    for (const char* name : {".tactnet-notes", "net", ".tactnet-12-2.partial"})
        CHECK_MESSAGE(std::filesystem::exists(folder / name), name);
    CHECK(tactnet::remove_abandoned_files(folder / "nothing") == 0);

    // A writer that stands still with its file open, and is then killed.
    const std::filesystem::path partial = tactnet::detail::partial_name(folder.path());
    int made[2];
    REQUIRE(pipe(made) == 0);
    const pid_t child = fork();
    if (child == 0) {
        tactnet::detail::writer_mark mark;
        {
            const auto file = tactnet::detail::open_file(partial, "wbx");
            static_cast<void>(mark.set(file.get()));
        } // the mark outlives the file
        static_cast<void>(write(made[1], "x", 1));
        for (;;)
            pause();
    }
    char byte = 0;
    REQUIRE(read(made[0], &byte, 1) == 1);
    CHECK(tactnet::remove_abandoned_files(folder.path()) == 0);
    CHECK(std::filesystem::exists(partial));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    CHECK(tactnet::remove_abandoned_files(folder.path()) == 1);
    CHECK_FALSE(std::filesystem::exists(partial));
    close(made[0]);
    close(made[1]);
}
#endif

TEST_CASE("remove_abandoned_files: no file of a concurrent writer is lost") {
    const support::temporary_folder folder;
    std::atomic<bool> done = false;
    std::thread tidies([&] {
        while (!done)
            tactnet::remove_abandoned_files(folder.path());
    });
    for (int i = 0; i < 300; ++i)
        CHECK_NOTHROW(tactnet::write_file(folder / std::to_string(i), "bytes"));
    done = true;
    tidies.join();
    CHECK(partial_files_in(folder.path()) == 0);
    for (int i = 0; i < 300; ++i)
        CHECK(std::filesystem::file_size(folder / std::to_string(i)) == 5);
}

} // namespace
