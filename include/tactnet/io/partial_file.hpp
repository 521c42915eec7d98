#pragma once

#include <tactnet/text/quoting.hpp>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string_view>
#include <system_error>

// Files have a temporary name while they are written. A writer that was killed leaves such a file behind; a
// lock, which ends with its process however that ends, distinguishes it from one that is still being written.
// A process number in the name would not: numbers are reused, and mean nothing on another machine or in a
// container.

#if defined(__unix__) || defined(__APPLE__)
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace tactnet { inline namespace TACTNET_ARCH {

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

}} // namespace tactnet
