#include "files/output_claim.hpp"

#include "usage_error.hpp"

#include <tactnet/io/safetensors/checksum.hpp>

#include <fmt/format.h>

#include <cerrno>
#include <cstdint>
#include <fcntl.h>
#include <filesystem>
#include <printable.hpp>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace {

/// The file whose lock stands for `path`: hidden and beside it, with a name that is never too long.
std::filesystem::path lock_file_of(const std::filesystem::path& path) {
    std::error_code code;
    std::filesystem::path whole = std::filesystem::weakly_canonical(path, code);
    if (code)
        whole = path;
    const std::uint64_t name = tactnet::xxh64().update(whole.filename().string()).digest();
    return whole.parent_path() / fmt::format(".tactnet-{:016x}.lock", name);
}

/// Whether the open file still has its name: the one who had it may have removed it just before.
bool has_name(int descriptor, const std::string& name) {
    struct stat open {
    }, named{};
    return ::fstat(descriptor, &open) == 0 && ::lstat(name.c_str(), &named) == 0 &&
           open.st_ino == named.st_ino && open.st_dev == named.st_dev;
}

} // namespace

output_claim::output_claim(const std::vector<named_file>& outputs) {
    try {
        for (const named_file& output : outputs)
            take(output);
    } catch (...) {
        end();
        throw;
    }
}

void output_claim::make_folders_of(const std::filesystem::path& file) {
    std::error_code code;
    std::vector<std::filesystem::path> missing;
    for (std::filesystem::path folder = file.parent_path();
         !folder.empty() && !std::filesystem::exists(folder, code); folder = folder.parent_path())
        missing.push_back(folder);
    for (; !missing.empty(); missing.pop_back())
        if (std::filesystem::create_directory(missing.back(), code))
            folders_.push_back(missing.back());
}

void output_claim::take(const named_file& output) {
    const std::filesystem::path file = lock_file_of(output.path);
    make_folders_of(file);
    const std::string name = file.string();
    locks_.reserve(locks_.size() + 1);
    for (;;) {
        const int descriptor = ::open(name.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (descriptor < 0)
            return;
        if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
            const bool taken = errno == EWOULDBLOCK;
            ::close(descriptor);
            if (taken)
                throw usage_error(fmt::format("{}: expected a file that no other program is about to write, "
                                              "found another training at work on {}",
                                              output.option, printable(output.path.string())));
            return;
        }
        if (has_name(descriptor, name)) {
            locks_.push_back({name, descriptor});
            return;
        }
        ::close(descriptor);
    }
}

void output_claim::end() noexcept {
    for (const lock& held : locks_) { // removed while it is held, so that nobody else's is
        ::unlink(held.file.c_str());
        ::close(held.descriptor);
    }
    locks_.clear();
    for (; !folders_.empty(); folders_.pop_back())
        ::rmdir(folders_.back().c_str()); // an empty one alone
}
