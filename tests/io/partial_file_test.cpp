#include <tactnet/io/partial_file.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/io/write_file.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <string>
#include <support/files/temporary_folder.hpp>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace fs = std::filesystem;

namespace {

std::size_t partial_files_in(const fs::path& folder) {
    const fs::directory_iterator entries(folder);
    return static_cast<std::size_t>(std::count_if(begin(entries), end(entries), [](const auto& entry) {
        return tactnet::is_partial_file_name(entry.path().filename().string());
    }));
}

} // namespace

TEST_SUITE("io") {
    TEST_CASE("is_partial_file_name: those of write_file, and no others") {
        CHECK(tactnet::is_partial_file_name(tactnet::detail::partial_name("folder").filename().string()));
        CHECK(tactnet::is_partial_file_name(".tactnet-1-0.partial"));
        for (const char* other :
             {"", ".tactnet-.partial", ".tactnet-1.partial", ".tactnet--1.partial", ".tactnet-1-.partial",
              ".tactnet-1-2-3.partial", ".tactnet-1-a.partial", "tactnet-1-2.partial",
              ".tactnet-1-2.partial2", "x.tactnet-1-2.partial", ".tactnet-partial", "net.safetensors"})
            CHECK_MESSAGE(!tactnet::is_partial_file_name(other), other);
    }

    TEST_CASE("remove_abandoned_files: what a killed writer left goes, what is being written stays") {
        const support::temporary_folder folder;
        for (const char* name : {".tactnet-12-0.partial", ".tactnet-12-1.partial", ".tactnet-notes", "net"})
            tactnet::write_file(folder / name, "x");
        fs::create_directory(folder / ".tactnet-12-2.partial");
        CHECK(tactnet::remove_abandoned_files(folder.path()) == 2);
        CHECK(tactnet::remove_abandoned_files(folder.path()) == 0);
        for (const char* name : {".tactnet-notes", "net", ".tactnet-12-2.partial"})
            CHECK_MESSAGE(fs::exists(folder / name), name);
        CHECK(tactnet::remove_abandoned_files(folder / "nothing") == 0);

        // A writer that stands still with its file open, and is then killed.
        const fs::path partial = tactnet::detail::partial_name(folder.path());
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
        CHECK(fs::exists(partial));
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        CHECK(tactnet::remove_abandoned_files(folder.path()) == 1);
        CHECK_FALSE(fs::exists(partial));
        close(made[0]);
        close(made[1]);
    }

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
            CHECK(fs::file_size(folder / std::to_string(i)) == 5);
    }
}
