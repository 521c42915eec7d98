#pragma once

// A program from outside: what it prints and how it ends.

#include <tactnet/io/read_file.hpp>

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <support/files/temporary_folder.hpp>
#include <sys/wait.h>

namespace support {

inline std::string text_of(const std::filesystem::path& path) {
    const auto bytes = tactnet::read_file(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

struct program_result {
    int status;
    std::string out, error;
};

/// Runs a command of the shell.
inline program_result run_program(const std::string& command) {
    const temporary_folder folder;
    const std::string out = (folder / "out").string(), error = (folder / "error").string();
    const int status = std::system(("( " + command + " ) >" + out + " 2>" + error).c_str());
    REQUIRE(WIFEXITED(status));
    return {WEXITSTATUS(status), text_of(out), text_of(error)};
}

} // namespace support
