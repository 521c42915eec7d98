#include "files/try_name.hpp"

#include "usage_error.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <fcntl.h>
#include <string>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace {

/// A hidden folder of its own, gone afterwards.
class trial_folder {
public:
    explicit trial_folder(const std::filesystem::path& parent)
        : path_((parent / ".tactnet-trial-XXXXXX").string()),
          made_(::mkdtemp(path_.data()) != nullptr),
          error_(made_ ? 0 : errno) {}
    trial_folder(const trial_folder&) = delete;
    trial_folder& operator=(const trial_folder&) = delete;
    ~trial_folder() {
        std::error_code ignored;
        if (made_)
            std::filesystem::remove_all(path_, ignored);
    }
    int error() const { return error_; }

    /// Makes folders and in them a file; 0 or the error number.
    int make(const std::filesystem::path& file) const {
        std::error_code code;
        const std::filesystem::path whole = path_ / file;
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
    std::string path_;
    bool made_;
    int error_;
};

} // namespace

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
    const trial_folder trial(folder);
    check(trial.error());
    check(trial.make(whole.lexically_relative(folder)));
}
