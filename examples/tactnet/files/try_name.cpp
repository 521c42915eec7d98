#include "files/try_name.hpp"

#include "usage_error.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <fcntl.h>
#include <string>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace {

constexpr std::string_view prefix = ".tactnet-trial-", random_part = "XXXXXX";

int open_folder(const std::filesystem::path& path) {
    return ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

/// A hidden folder of its own, gone afterwards. While it lives it is locked, so that nobody takes it for one
/// that a killed program has left.
class trial_folder {
public:
    explicit trial_folder(const std::filesystem::path& parent) {
        for (int attempt = 0; attempt < 10 && !made_; ++attempt) {
            path_ = (parent / prefix).string().append(random_part);
            made_ = ::mkdtemp(path_.data()) != nullptr;
            error_ = made_ ? 0 : errno;
            if (!made_)
                return;
            descriptor_ = open_folder(path_);
            // Somebody tidied between the two.
            const bool gone = descriptor_ < 0 ? errno == ENOENT
                              : ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0
                                  ? errno == EWOULDBLOCK
                                  : ::access(path_.c_str(), F_OK) != 0;
            if (gone) {
                end();
                error_ = EAGAIN; // unless a later attempt succeeds
            }
        }
    }
    trial_folder(const trial_folder&) = delete;
    trial_folder& operator=(const trial_folder&) = delete;
    ~trial_folder() { end(); }
    int error() const { return error_; }

    /// Makes folders and in them a file; 0 or the error number.
    int make(const std::filesystem::path& file) {
        std::error_code code;
        const std::filesystem::path whole = path_ / file;
        inside_ = whole;
        std::filesystem::create_directories(whole.parent_path(), code);
        if (code)
            return code.value();
        const int descriptor = ::open(whole.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
        if (descriptor < 0)
            return errno;
        ::close(descriptor);
        return 0;
    }

private:
    void end() {
        // Name by name: to walk through folders would take files that the system may refuse to open.
        if (made_ && !inside_.empty()) {
            ::unlink(inside_.c_str());
            for (auto folder = inside_.parent_path(); folder.native().size() > path_.size();
                 folder = folder.parent_path())
                ::rmdir(folder.c_str());
        }
        if (made_)
            ::rmdir(path_.c_str());
        made_ = false;
        if (descriptor_ >= 0)
            ::close(descriptor_);
        descriptor_ = -1;
    }

    std::string path_;
    std::filesystem::path inside_; ///< the file in it
    bool made_ = false;
    int error_ = EAGAIN, descriptor_ = -1;
};

} // namespace

void remove_abandoned_trials(const std::filesystem::path& folder) {
    std::error_code code;
    auto walk = std::filesystem::directory_iterator(folder.empty() ? "." : folder, code);
    for (; !code && walk != std::filesystem::directory_iterator(); walk.increment(code)) {
        const std::string name = walk->path().filename().string();
        if (!name.starts_with(prefix) || name.size() != prefix.size() + random_part.size())
            continue;
        const int descriptor = open_folder(walk->path());
        if (descriptor < 0)
            continue;
        std::error_code ignored;
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0)
            std::filesystem::remove_all(walk->path(), ignored);
        ::close(descriptor);
    }
}

void try_name(const std::filesystem::path& path) {
    const auto check = [&](int error) {
        if (error != 0)
            throw usage_error(fmt::format("{}: expected the name of a file that can be written, found '{}'",
                                          path.string(), std::generic_category().message(error)));
    };
    struct stat status {};
    if (::lstat(path.c_str(), &status) == 0)
        return; // the name is in use already
    if (errno != ENOENT)
        check(errno);
    std::error_code code;
    const std::filesystem::path whole = std::filesystem::absolute(path).lexically_normal();
    std::filesystem::path folder = whole.parent_path();
    while (!std::filesystem::is_directory(folder, code) && folder != folder.parent_path())
        folder = folder.parent_path();
    remove_abandoned_trials(folder);
    trial_folder trial(folder);
    check(trial.error());
    check(trial.make(whole.lexically_relative(folder)));
}
