#pragma once

#include <tactnet/io/file_error.hpp>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>
#if defined(__unix__) || defined(__APPLE__)
#define TACTNET_POSIX_FILES
#include <sys/stat.h>
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

/// The most bytes that `read_file` reads by default: 2 GiB less one.
inline constexpr std::size_t default_file_limit = 0x7fff'ffff;

/// The most bytes that `read_file` reads from a character device, which may have no end: 64 MiB.
inline constexpr std::size_t device_limit = std::size_t{1} << 26U;

namespace detail {

struct close_file {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};
using file_handle = std::unique_ptr<std::FILE, close_file>;

inline file_handle open_file(const file_name& path, const char* mode) {
    errno = 0;
#if defined(_WIN32)
    const std::wstring wide_mode(mode, mode + std::char_traits<char>::length(mode));
    return file_handle(::_wfopen(path.c_str(), wide_mode.c_str()));
#else
    return file_handle(std::fopen(path.c_str(), mode));
#endif
}

/// The system's sentence for an error number, in quotes.
[[gnu::cold, gnu::noinline]] inline std::string error_text(int code) {
    return code == 0 ? "'an unknown error'" : joined({"'", std::generic_category().message(code), "'"});
}

enum class file_kind { missing, folder, named_pipe, character_device, other };

/// What the system knows of a file, following links. The size is that of a regular file.
struct file_status {
    file_kind kind = file_kind::other;
    std::optional<std::uintmax_t> size = std::nullopt;
};

/// Opening a named pipe would wait for another program, perhaps for ever. A pipe that a shell makes between
/// two programs does not: on Linux its name under /dev/fd leads nowhere. Elsewhere it counts as a named pipe.
[[gnu::cold]] inline file_status status_of(const file_name& path) {
#if defined(TACTNET_POSIX_FILES)
    struct ::stat found {};
    if (::stat(path.c_str(), &found) != 0)
        return {errno == ENOENT || errno == ENOTDIR ? file_kind::missing : file_kind::other};
    if (S_ISREG(found.st_mode))
        return {file_kind::other, static_cast<std::uintmax_t>(found.st_size)};
    if (S_ISFIFO(found.st_mode)) {
        const std::unique_ptr<char, void (*)(void*)> place(::realpath(path.c_str(), nullptr), std::free);
        return {place == nullptr ? file_kind::other : file_kind::named_pipe};
    }
    return {S_ISDIR(found.st_mode)   ? file_kind::folder
            : S_ISCHR(found.st_mode) ? file_kind::character_device
                                     : file_kind::other};
#else
    using std::filesystem::file_type;
    std::error_code code;
    const file_type type = std::filesystem::status(path, code).type();
    const std::uintmax_t size = std::filesystem::file_size(path, code);
    const bool has_size = !code;
    if (type == file_type::fifo)
        static_cast<void>(std::filesystem::canonical(path, code));
    return {type == file_type::not_found       ? file_kind::missing
            : type == file_type::directory     ? file_kind::folder
            : type == file_type::fifo && !code ? file_kind::named_pipe
            : type == file_type::character     ? file_kind::character_device
                                               : file_kind::other,
            has_size ? std::optional(size) : std::nullopt};
#endif
}

} // namespace detail

/// Returns all bytes of the file at `path`. A pipe between two programs, such as a shell makes, is read to
/// its end. Throws file_error when the file is missing, a folder, a named pipe (which has no bytes until a
/// program writes them), unreadable, longer than `limit` bytes, or a device that gives more than
/// `device_limit`.
[[gnu::cold]] inline std::vector<std::byte> read_file(const file_name& path,
                                                      std::size_t limit = default_file_limit) {
    using detail::file_kind;
    const detail::file_status status = detail::status_of(path);
    const std::string& name = path.string();
    if (const char* const found = status.kind == file_kind::missing      ? "nothing of that name"
                                  : status.kind == file_kind::folder     ? "a folder"
                                  : status.kind == file_kind::named_pipe ? "a named pipe"
                                                                         : nullptr)
        detail::throw_file_error(name, {}, {"a file"}, {found});
    const auto file = detail::open_file(path, "rb");
    if (!file)
        detail::throw_file_error(name, {}, {"a readable file"}, {detail::error_text(errno)});

    if (status.kind == file_kind::character_device)
        limit = std::min(limit, device_limit);
    std::vector<std::byte> bytes;
    // A size within the limit is only a hint: a file may grow while it is read, and devices have none.
    if (status.size) {
        if (*status.size > limit)
            detail::throw_file_error(name, {}, {"at most ", limit, " bytes"}, {*status.size, " bytes"});
        bytes.reserve(static_cast<std::size_t>(*status.size) + 1);
    }
    constexpr std::size_t step = std::size_t{1} << 20;
    for (;;) {
        const std::size_t have = bytes.size();
        const std::size_t room = bytes.capacity() > have ? bytes.capacity() - have : step;
        bytes.resize(have + room);
        errno = 0;
        const std::size_t got = std::fread(bytes.data() + have, 1, room, file.get());
        bytes.resize(have + got);
        if (bytes.size() > limit)
            detail::throw_file_error(name, {}, {"at most ", limit, " bytes"}, {"more"});
        if (got < room) {
            if (std::ferror(file.get()) != 0)
                detail::throw_file_error(name, {"byte ", bytes.size()}, {"to read on"},
                                         {detail::error_text(errno)});
            return bytes;
        }
    }
}

}} // namespace tactnet
