#pragma once

#include <tactnet/detail/config.hpp>

#if defined(__unix__) || defined(__APPLE__)
#define TACTNET_POSIX_FILES
#include <string>
#include <string_view>
#include <sys/stat.h>
#include <utility>
#else
#include <filesystem>
#endif

namespace tactnet { inline namespace TACTNET_ARCH {

#if defined(TACTNET_POSIX_FILES)

/// The name of a file to read, from text or from a std::filesystem::path. A type of its own, since
/// <filesystem> would be a tenth of what a program that loads a network compiles.
class file_name {
public:
    file_name(const char* name) : name_(name) {}
    file_name(std::string_view name) : name_(name) {}
    file_name(std::string name) : name_(std::move(name)) {}
    template <class Path>
        requires requires(const Path& path) {
            path.native();
            path.lexically_normal();
        }
    file_name(const Path& path) : name_(path.native()) {}

    [[nodiscard]] const std::string& string() const noexcept { return name_; }
    [[nodiscard]] const char* c_str() const noexcept { return name_.c_str(); }

private:
    std::string name_;
};

#else

/// The name of a file to read.
using file_name = std::filesystem::path;

#endif

}} // namespace tactnet
