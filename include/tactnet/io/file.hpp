#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/partial_file.hpp>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

// Whole files in and out. A reader gets all of a file or a sentence that says why not; a writer leaves either
// the old file or the new one, also when the disk fills up or the program is killed half-way: the bytes go to
// a temporary file in the same folder, are flushed to the disk, and take the name by a rename, which is
// atomic.

#if defined(__unix__) || defined(__APPLE__)
#include <fcntl.h>
#include <unistd.h>
#endif

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What `read_file` refuses to exceed unless told otherwise, in bytes: 2 GiB less one.
inline constexpr std::size_t default_file_limit = 0x7fff'ffff;

/// The same for a character device, which may have no end: 64 MiB.
inline constexpr std::size_t device_limit = std::size_t{1} << 26U;

/// Gives the bytes of a file, one piece after the other, to the function that it is called with.
using piece_giver = std::function<void(const std::function<void(std::span<const std::byte>)>&)>;

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

inline std::string error_text(int code) {
    return code == 0 ? std::string("an unknown error") : std::generic_category().message(code);
}

/// Opening one waits for its other end, which may never come. A pipe between two programs ends when the
/// other one does; its name under /dev/fd leads nowhere (on Linux; elsewhere it is taken for a named one).
inline bool is_named_pipe(const std::filesystem::path& path, std::filesystem::file_status status) {
    if (status.type() != std::filesystem::file_type::fifo)
        return false;
    std::error_code code;
    static_cast<void>(std::filesystem::canonical(path, code));
    return !code;
}

/// Returns 0 or the error number. A file is only on the disk when the system says so.
inline int write_and_flush(std::FILE* file, const piece_giver& give) {
    errno = 0;
    int error = 0;
    give([&](std::span<const std::byte> piece) {
        if (error == 0 && !piece.empty() && std::fwrite(piece.data(), 1, piece.size(), file) != piece.size())
            error = errno != 0 ? errno : EIO;
    });
    if (error != 0)
        return error;
    if (std::fflush(file) != 0)
        return errno != 0 ? errno : EIO;
#if defined(__unix__) || defined(__APPLE__)
    // Pipes and terminals cannot be synchronised, and say so with EINVAL.
    if (::fsync(::fileno(file)) != 0 && errno != EINVAL && errno != ENOTSUP && errno != EROFS)
        return errno;
#endif
    return 0;
}

/// The rename itself is on the disk only once the folder is; if that cannot be had the file is still whole.
inline void flush_folder([[maybe_unused]] const std::filesystem::path& folder) noexcept {
#if defined(__unix__) || defined(__APPLE__)
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor >= 0) {
        static_cast<void>(::fsync(descriptor));
        ::close(descriptor);
    }
#endif
}

} // namespace detail

/// All bytes of the file at `path`. A pipe between two programs, such as a shell gives, is read to its end.
/// Throws file_error when it is missing, a folder, a named pipe (which has no bytes until someone comes to
/// write them), unreadable, longer than `limit` bytes, or a device that gives more than `device_limit`.
inline std::vector<std::byte> read_file(const std::filesystem::path& path,
                                        std::size_t limit = default_file_limit) {
    std::error_code code;
    const auto status = std::filesystem::status(path, code);
    if (status.type() == std::filesystem::file_type::not_found)
        throw file_error(path.string(), "", "a file", "nothing of that name");
    if (status.type() == std::filesystem::file_type::directory)
        throw file_error(path.string(), "", "a file", "a folder");
    if (detail::is_named_pipe(path, status))
        throw file_error(path.string(), "", "a file", "a named pipe");
    const auto file = detail::open_file(path, "rb");
    if (!file)
        throw file_error(path.string(), "", "a readable file", "'" + detail::error_text(errno) + "'");

    if (status.type() == std::filesystem::file_type::character)
        limit = std::min(limit, device_limit);
    const auto too_large = [&](const std::string& found) {
        return file_error(path.string(), "", "at most " + std::to_string(limit) + " bytes", found);
    };
    std::vector<std::byte> bytes;
    // A size within the limit is only a hint: a file may grow while it is read, and devices have none.
    if (const auto size = std::filesystem::file_size(path, code); !code) {
        if (size > limit)
            throw too_large(std::to_string(size) + " bytes");
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
            throw too_large("more");
        if (got < room) {
            if (std::ferror(file.get()) != 0)
                throw file_error(path.string(), "byte " + std::to_string(bytes.size()), "to read on",
                                 "'" + detail::error_text(errno) + "'");
            return bytes;
        }
    }
}

/// Writes the pieces one after the other as the file at `path`, all or nothing. An existing file is replaced
/// and its permissions are kept; a link is followed; a device or pipe is written to directly. Throws
/// file_error, and what the giver throws; what was there before is then untouched and no temporary file stays
/// behind. What a killed writer leaves, `remove_abandoned_files` finds.
inline void write_file(const std::filesystem::path& path, const piece_giver& give) {
    using std::filesystem::file_type;
    const auto fail = [&](const char* expected, int code) {
        throw file_error(path.string(), "", expected, "'" + detail::error_text(code) + "'");
    };
    std::error_code code;
    const auto status = std::filesystem::status(path, code);
    if (status.type() == file_type::directory || path.filename().empty())
        throw file_error(path.string(), "", "a file to write", "a folder");
    if (status.type() != file_type::regular && std::filesystem::exists(status)) {
        const auto device = detail::open_file(path, "wb");
        if (!device)
            fail("a writable file", errno);
        if (const int error = detail::write_and_flush(device.get(), give); error != 0)
            fail("to write all bytes", error);
        return;
    }

    std::filesystem::path target = path;
    if (std::filesystem::is_symlink(path, code))
        if (auto resolved = std::filesystem::weakly_canonical(path, code); !code)
            target = std::move(resolved);
    const auto folder = target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");

    std::filesystem::path temporary;
    detail::file_handle file;
    detail::writer_mark mark; // beyond the rename
    for (int attempt = 0; attempt < 100 && !file; ++attempt) {
        temporary = detail::partial_name(folder);
        file = detail::open_file(temporary, "wbx");
        if (!file && errno != EEXIST)
            fail("a folder to write in", errno);
        if (file && !mark.set(file.get()))
            file.reset();
    }
    if (!file)
        fail("a folder to write in", EEXIST);

    int error = 0;
    try {
        error = detail::write_and_flush(file.get(), give);
    } catch (...) {
        file.reset();
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        throw;
    }
    if (std::fclose(file.release()) != 0 && error == 0)
        error = errno != 0 ? errno : EIO;
    code.clear();
    if (error == 0) {
        if (std::filesystem::exists(status))
            std::filesystem::permissions(temporary, status.permissions(), code);
        code.clear();
        std::filesystem::rename(temporary, target, code);
        error = code.value();
    }
    if (error != 0) {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        fail("to write all bytes", error);
    }
    detail::flush_folder(folder);
}

/// The same for pieces that are there already.
inline void write_file(const std::filesystem::path& path,
                       std::span<const std::span<const std::byte>> pieces) {
    write_file(path, [=](const std::function<void(std::span<const std::byte>)>& take) {
        for (const auto piece : pieces)
            take(piece);
    });
}

/// The same for bytes in one piece.
inline void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    write_file(path, std::span<const std::span<const std::byte>>(&bytes, 1));
}

/// The same for text, byte by byte: line ends are not translated.
inline void write_file(const std::filesystem::path& path, std::string_view text) {
    write_file(path, std::as_bytes(std::span(text.data(), text.size())));
}

} // namespace TACTNET_ARCH
} // namespace tactnet
