#include "files/claims.hpp"

#include <tactnet/io/safetensors/format.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <fcntl.h>
#include <string_view>
#include <sys/stat.h>
#include <system_error>
#include <thread>
#include <unistd.h>
#if defined(_WIN32)
#include <io.h>
#include <share.h>
#else
#include <sys/file.h>
#endif

namespace {

constexpr std::string_view lock_prefix = ".tactnet-", lock_suffix = ".lock";
constexpr std::size_t lock_digits = 16;

/// A hidden file in the same folder, whose name is never too long.
std::filesystem::path lock_file_of(const std::filesystem::path& path) {
    std::error_code code;
    std::filesystem::path whole = std::filesystem::weakly_canonical(path, code);
    if (code)
        whole = path;
    const auto name = tactnet::xxh64().update(whole.filename().string()).digest();
    return whole.parent_path() / fmt::format("{}{:0{}x}{}", lock_prefix, name, lock_digits, lock_suffix);
}

#if defined(_WIN32)

void remove_and_close(const std::filesystem::path&, int descriptor) noexcept {
    ::_close(descriptor); // at which the system removes it
}

#else

bool is_lock_file(std::string_view name) {
    return name.size() == lock_prefix.size() + lock_digits + lock_suffix.size() &&
           name.starts_with(lock_prefix) && name.ends_with(lock_suffix);
}

/// Whether the open file still has its name: its holder may have removed it just before.
bool has_name(int descriptor, const std::filesystem::path& name) {
    struct stat open {
    }, named{};
    return ::fstat(descriptor, &open) == 0 && ::lstat(name.c_str(), &named) == 0 &&
           open.st_ino == named.st_ino && open.st_dev == named.st_dev;
}

void remove_and_close(const std::filesystem::path& file, int descriptor) noexcept {
    ::unlink(file.c_str()); // while it is locked, so that no other program's is removed
    ::close(descriptor);
}

#endif

} // namespace

claims::~claims() {
    for (const lock& held : locks_)
        remove_and_close(held.file, held.descriptor);
    std::error_code ignored;
    for (; !folders_.empty(); folders_.pop_back())
        std::filesystem::remove(folders_.back(), ignored); // empty folders only
}

bool claims::take(const std::filesystem::path& name) {
    const std::filesystem::path file = lock_file_of(name);
    std::error_code code;
    std::vector<std::filesystem::path> missing;
    for (auto folder = file.parent_path(); !folder.empty() && !std::filesystem::exists(folder, code);
         folder = folder.parent_path())
        missing.push_back(folder);
    for (; !missing.empty(); missing.pop_back())
        if (std::filesystem::create_directory(missing.back(), code))
            folders_.push_back(missing.back());
    locks_.reserve(locks_.size() + 1);
#if defined(_WIN32) // where nobody else opens it meanwhile, and it goes with its program
    const int descriptor = ::_wsopen(file.c_str(), _O_RDWR | _O_CREAT | _O_TEMPORARY | _O_NOINHERIT,
                                     _SH_DENYRW, _S_IREAD | _S_IWRITE);
    if (descriptor < 0)
        return errno != EACCES || !std::filesystem::exists(file, code);
    locks_.push_back({file, descriptor});
    return true;
#else
    for (;;) {
        const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (descriptor < 0)
            return true;
        if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
            const bool taken = errno == EWOULDBLOCK;
            ::close(descriptor);
            return !taken;
        }
        if (has_name(descriptor, file)) {
            locks_.push_back({file, descriptor});
            return true;
        }
        ::close(descriptor);
    }
#endif
}

bool claims::take_soon(const std::filesystem::path& name) {
    using namespace std::chrono_literals;
    for (int tries = 0; tries < 50; ++tries, std::this_thread::sleep_for(10ms))
        if (take(name))
            return true;
    return false;
}

void claims::release(const std::filesystem::path& name) {
    const auto held = std::ranges::find(locks_, lock_file_of(name), &lock::file);
    if (held == locks_.end())
        return;
    remove_and_close(held->file, held->descriptor);
    locks_.erase(held);
}

void remove_abandoned_claims([[maybe_unused]] const std::filesystem::path& folder) {
#if !defined(_WIN32) // there is none there
    std::error_code code;
    auto walk = std::filesystem::directory_iterator(folder.empty() ? "." : folder, code);
    for (; !code && walk != std::filesystem::directory_iterator(); walk.increment(code)) {
        if (!is_lock_file(walk->path().filename().string()))
            continue;
        const std::filesystem::path& file = walk->path();
        const int descriptor = ::open(file.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        if (descriptor < 0)
            continue;
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && has_name(descriptor, file))
            remove_and_close(file, descriptor);
        else
            ::close(descriptor);
    }
#endif
}
