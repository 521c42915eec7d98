#pragma once

#include <tactnet/detail/function_ref.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/text/message.hpp>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>
#if defined(__unix__) || defined(__APPLE__)
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

// Writing leaves either the old file or the new one, also when the disk fills up or the program is killed
// half-way: the bytes go to a temporary file in the same folder, are flushed to the disk, and get the name by
// a rename, which is atomic.

namespace tactnet { inline namespace TACTNET_ARCH {

// Files have a temporary name while they are written. A writer that was killed leaves such a file behind; a
// lock, which ends with its process however that ends, distinguishes it from one that is still being written.
// A process number in the name would not: numbers are reused, and mean nothing on another machine or in a
// container.

namespace detail {

inline constexpr std::string_view partial_prefix = ".tactnet-", partial_suffix = ".partial";

/// A hidden name that no other writer uses: exclusive creation decides, the number only makes clashes rare.
[[gnu::cold]] inline std::filesystem::path partial_name(const std::filesystem::path& folder) {
    static std::atomic<std::uint64_t> calls{0};
    const auto now = static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
    return folder / joined({partial_prefix, now, "-", calls++, partial_suffix});
}

/// Marks a partial file as being written, for the lifetime of this object.
class writer_mark {
public:
    writer_mark() = default;
    writer_mark(const writer_mark&) = delete;
    writer_mark& operator=(const writer_mark&) = delete;
    ~writer_mark() { clear(); }

    /// Marks the file, also after it is closed. Returns false if another process has just removed it as
    /// abandoned; the file must then not be used. Systems without locks have no marks, and remove no files.
    bool set([[maybe_unused]] std::FILE* file) noexcept {
        clear();
#if defined(__unix__) || defined(__APPLE__)
        const int descriptor = ::fileno(file);
        if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0)
            return errno != EWOULDBLOCK;
        descriptor_ = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
        struct stat status {};
        return ::fstat(descriptor, &status) != 0 || status.st_nlink > 0;
#else
        return true;
#endif
    }

private:
    void clear() noexcept {
#if defined(__unix__) || defined(__APPLE__)
        if (descriptor_ >= 0)
            ::close(descriptor_);
        descriptor_ = -1;
#endif
    }

    [[maybe_unused]] int descriptor_ = -1;
};

} // namespace detail

/// Whether `write_file` uses this name for files that it is writing: ".tactnet-NUMBER-NUMBER.partial".
[[nodiscard]] inline bool is_partial_file_name(std::string_view name) noexcept {
    if (!name.starts_with(detail::partial_prefix) || !name.ends_with(detail::partial_suffix) ||
        name.size() < detail::partial_prefix.size() + detail::partial_suffix.size())
        return false;
    name.remove_prefix(detail::partial_prefix.size());
    name.remove_suffix(detail::partial_suffix.size());
    const std::size_t dash = name.find('-');
    return dash != 0 && dash != std::string_view::npos && dash + 1 < name.size() &&
           name.find_first_not_of("0123456789") == dash &&
           name.find_first_not_of("0123456789", dash + 1) == std::string_view::npos;
}

/// Removes the partial files in a folder (not in its subfolders) whose writers have ended, and returns their
/// number. Files that are still being written stay; without locks in the system all stay. A folder that is
/// missing or cannot be read is no error: there is nothing to remove.
[[gnu::cold]] inline std::size_t
remove_abandoned_files([[maybe_unused]] const std::filesystem::path& folder) {
    std::size_t removed = 0;
#if defined(__unix__) || defined(__APPLE__)
    std::error_code code;
    auto walk = std::filesystem::directory_iterator(folder.empty() ? "." : folder, code);
    for (; !code && walk != std::filesystem::directory_iterator(); walk.increment(code)) {
        const std::filesystem::path& path = walk->path();
        if (!is_partial_file_name(path.filename().string()))
            continue;
        const int descriptor = ::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        if (descriptor < 0)
            continue;
        // A writer that has just made the file notices this lock and makes another file.
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && ::unlink(path.c_str()) == 0)
            ++removed;
        ::close(descriptor);
    }
#endif
    return removed;
}

/// Takes the bytes of a file, one piece after the other.
using chunk_sink = detail::function_ref<void(std::span<const std::byte>)>;
/// Passes the bytes of a file, one piece after the other, to the function that it is called with.
using chunk_source = std::function<void(chunk_sink)>;

namespace detail {

/// Writes all pieces to an open file and flushes it to the disk. Returns 0 or the error number.
[[gnu::cold]] inline int write_and_flush(std::FILE* file, function_ref<void(chunk_sink)> give) {
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
    // Pipes and terminals cannot be synchronised, and report EINVAL.
    if (::fsync(::fileno(file)) != 0 && errno != EINVAL && errno != ENOTSUP && errno != EROFS)
        return errno;
#endif
    return 0;
}

/// Flushes a rename in the folder to the disk. Should that fail, the file is still whole.
inline void flush_folder([[maybe_unused]] const std::filesystem::path& folder) noexcept {
#if defined(__unix__) || defined(__APPLE__)
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor >= 0) {
        static_cast<void>(::fsync(descriptor));
        ::close(descriptor);
    }
#endif
}

/// `write_file` for a giver of any type.
[[gnu::cold]] inline void write_pieces(const std::filesystem::path& path,
                                       function_ref<void(chunk_sink)> give) {
    using std::filesystem::file_type;
    const auto fail = [&](const char* expected, int code) {
        throw_file_error(path.string(), {}, {expected}, {error_text(code)});
    };
    std::error_code code;
    const auto status = std::filesystem::status(path, code);
    if (status.type() == file_type::directory || path.filename().empty())
        throw_file_error(path.string(), {}, {"a file to write"}, {"a folder"});
    if (status.type() != file_type::regular && std::filesystem::exists(status)) {
        const auto device = open_file(path, "wb");
        if (!device)
            fail("a writable file", errno);
        if (const int error = write_and_flush(device.get(), give); error != 0)
            fail("to write all bytes", error);
        return;
    }

    std::filesystem::path target = path;
    if (std::filesystem::is_symlink(path, code))
        if (auto resolved = std::filesystem::weakly_canonical(path, code); !code)
            target = std::move(resolved);
    const auto folder = target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");

    std::filesystem::path temporary;
    file_handle file;
    writer_mark mark; // lasts beyond the rename
    for (int attempt = 0; attempt < 100 && !file; ++attempt) {
        temporary = partial_name(folder);
        file = open_file(temporary, "wbx");
        if (!file && errno != EEXIST)
            fail("a folder to write in", errno);
        if (file && !mark.set(file.get()))
            file.reset();
    }
    if (!file)
        fail("a folder to write in", EEXIST);

    const auto remove_temporary = [&] {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
    };
    int error = 0;
    try {
        error = write_and_flush(file.get(), give);
    } catch (...) {
        file.reset();
        remove_temporary();
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
        remove_temporary();
        fail("to write all bytes", error);
    }
    flush_folder(folder);
}

} // namespace detail

/// Writes the pieces one after the other as the file at `path`, all or nothing. An existing file is replaced
/// and its permissions are kept; a link is followed; a device or pipe is written to directly. Throws
/// file_error, and what the giver throws; the old file is then untouched and no temporary file stays behind.
/// `remove_abandoned_files` removes what a killed writer leaves.
inline void write_file(const std::filesystem::path& path, const chunk_source& give) {
    detail::write_pieces(path, give);
}
/// Writes pieces that are in memory.
inline void write_file(const std::filesystem::path& path,
                       std::span<const std::span<const std::byte>> pieces) {
    detail::write_pieces(path, [&](chunk_sink take) {
        for (const auto piece : pieces)
            take(piece);
    });
}
/// Writes bytes in one piece.
inline void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
    detail::write_pieces(path, [&](chunk_sink take) { take(bytes); });
}
/// Writes a text, byte by byte: line ends are not translated.
inline void write_file(const std::filesystem::path& path, std::string_view text) {
    write_file(path, std::as_bytes(std::span(text.data(), text.size())));
}

}} // namespace tactnet
