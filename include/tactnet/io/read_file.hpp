#pragma once

#include <tactnet/io/file_error.hpp>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The most bytes that `read_file` reads by default: 2 GiB less one.
inline constexpr std::size_t default_file_limit = 0x7fff'ffff;

/// The most bytes that `read_file` reads from a character device, which may have no end: 64 MiB.
inline constexpr std::size_t device_limit = std::size_t{1} << 26U;

namespace detail {

struct close_file {
    void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};
using file_handle = std::unique_ptr<std::FILE, close_file>;

inline file_handle open_file(const std::filesystem::path& path, const char* mode) {
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

/// Whether opening the file would wait for another program, perhaps for ever. A pipe that a shell makes
/// between two programs does not: on Linux its name under /dev/fd leads nowhere. Elsewhere it counts as a
/// named pipe.
inline bool is_named_pipe(const std::filesystem::path& path, std::filesystem::file_status status) {
    if (status.type() != std::filesystem::file_type::fifo)
        return false;
    std::error_code code;
    static_cast<void>(std::filesystem::canonical(path, code));
    return !code;
}

} // namespace detail

/// Returns all bytes of the file at `path`. A pipe between two programs, such as a shell makes, is read to
/// its end. Throws file_error when the file is missing, a folder, a named pipe (which has no bytes until a
/// program writes them), unreadable, longer than `limit` bytes, or a device that gives more than
/// `device_limit`.
[[gnu::cold]] inline std::vector<std::byte> read_file(const std::filesystem::path& path,
                                                      std::size_t limit = default_file_limit) {
    using std::filesystem::file_type;
    std::error_code code;
    const auto status = std::filesystem::status(path, code);
    const std::string name = path.string();
    if (const char* const found = status.type() == file_type::not_found   ? "nothing of that name"
                                  : status.type() == file_type::directory ? "a folder"
                                  : detail::is_named_pipe(path, status)   ? "a named pipe"
                                                                          : nullptr)
        detail::throw_file_error(name, {}, {"a file"}, {found});
    const auto file = detail::open_file(path, "rb");
    if (!file)
        detail::throw_file_error(name, {}, {"a readable file"}, {detail::error_text(errno)});

    if (status.type() == file_type::character)
        limit = std::min(limit, device_limit);
    std::vector<std::byte> bytes;
    // A size within the limit is only a hint: a file may grow while it is read, and devices have none.
    if (const auto size = std::filesystem::file_size(path, code); !code) {
        if (size > limit)
            detail::throw_file_error(name, {}, {"at most ", limit, " bytes"}, {size, " bytes"});
        bytes.reserve(static_cast<std::size_t>(size) + 1);
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

} // namespace TACTNET_ARCH
} // namespace tactnet
