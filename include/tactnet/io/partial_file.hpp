#pragma once

#include <tactnet/detail/config.hpp>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

// Files under a temporary name while they are being written. A writer that was killed leaves one behind; a
// lock, which ends with its process however that ends, tells such a file from one that is still being
// written. A process number in the name would not: numbers are used again, and mean nothing on another
// machine or in a container.

#if defined(__unix__) || defined(__APPLE__)
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

inline constexpr std::string_view partial_prefix = ".tactnet-", partial_suffix = ".partial";

/// A hidden name that no other writer uses: exclusive creation decides, the number only makes clashes rare.
inline std::filesystem::path partial_name(const std::filesystem::path& folder) {
    static std::atomic<std::uint64_t> calls{0};
    const auto now = static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
    std::string name(partial_prefix);
    name += std::to_string(now) + "-" + std::to_string(calls++);
    return folder / name.append(partial_suffix);
}

/// Says that a partial file's writer is alive, for as long as this lives.
class writer_mark {
public:
    writer_mark() = default;
    writer_mark(const writer_mark&) = delete;
    writer_mark& operator=(const writer_mark&) = delete;
    ~writer_mark() { clear(); }

    /// Marks the file also beyond its closing. False when it was taken for abandoned just before, and must
    /// not be used. Where the system knows no locks there is no mark, and nobody takes it for abandoned.
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

/// Whether `write_file` gives this name to files that it is writing: ".tactnet-NUMBER-NUMBER.partial".
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

/// Removes the partial files in a folder (not in its subfolders) whose writers are gone; tells how many. What
/// is still being written stays, and so does all where the system knows no locks. A folder that is missing
/// or cannot be read is no error: there is nothing to tidy.
inline std::size_t remove_abandoned_files([[maybe_unused]] const std::filesystem::path& folder) {
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
        // While the lock is held here, a writer that has only just made the file sees that and takes another.
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && ::unlink(path.c_str()) == 0)
            ++removed;
        ::close(descriptor);
    }
#endif
    return removed;
}

} // namespace TACTNET_ARCH
} // namespace tactnet
