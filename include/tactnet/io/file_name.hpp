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
#include <string>
#include <string_view>
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

/// The name of a file to read, from UTF-8 text or from a path. Windows has names of wide characters, and its
/// libraries differ in what they make of others.
class file_name : public std::filesystem::path {
public:
    file_name(const char* name) : file_name(std::string_view(name)) {}
    file_name(std::string_view name) : path(std::u8string(name.begin(), name.end())) {}
    file_name(const std::string& name) : file_name(std::string_view(name)) {}
    file_name(const std::filesystem::path& name) : path(name) {}

    [[nodiscard]] std::string string() const {
        const std::u8string name = u8string();
        return {name.begin(), name.end()};
    }
};

#endif

}} // namespace tactnet
