#include "files/line_file.hpp"

#include "data/regular_file.hpp"
#include "reports/report.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>

#include <fmt/format.h>

#include <cerrno>
#include <cstddef>
#include <exception>
#include <fcntl.h>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace {

/// A file that other programs may write to as well; while it is open, it is this one's alone.
class locked_file {
public:
    /// Throws std::system_error, as all functions do.
    explicit locked_file(const std::filesystem::path& path)
        : descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
        check(descriptor_);
        int locked = 0;
        while ((locked = ::flock(descriptor_, LOCK_EX)) != 0 && errno == EINTR)
            ;
        if (locked != 0) {
            const int error = errno;
            ::close(descriptor_);
            throw std::system_error(error, std::generic_category());
        }
    }
    locked_file(const locked_file&) = delete;
    locked_file& operator=(const locked_file&) = delete;
    ~locked_file() { ::close(descriptor_); }

    /// Appends a line that ends in a line feed, on the disk when this returns. The beginning of a line that
    /// was never finished is cut off first: whoever wrote it has failed or is dead, or it would hold the
    /// lock.
    void add_line(std::string_view line) {
        check(::ftruncate(descriptor_, end_of_last_line()));
        const ssize_t written = ::write(descriptor_, line.data(), line.size());
        check(written);
        if (written != static_cast<ssize_t>(line.size())) // a full disk takes what it can
            throw std::system_error(ENOSPC, std::generic_category());
        check(::fsync(descriptor_));
    }

private:
    static void check(ssize_t result) {
        if (result < 0)
            throw std::system_error(errno, std::generic_category());
    }

    off_t end_of_last_line() const {
        struct stat status {};
        check(::fstat(descriptor_, &status));
        off_t end = status.st_size;
        char last = 0;
        while (end > 0 && ::pread(descriptor_, &last, 1, end - 1) == 1 && last != '\n')
            --end;
        return end;
    }

    int descriptor_;
};

} // namespace

void line_file::read_on(const std::string& expected, const std::function<void(const std::string&)>& take) {
    std::error_code code;
    if (!std::filesystem::exists(path_, code))
        return;
    check_no_device(path_);
    if (std::filesystem::file_size(path_, code) == bytes_)
        return;
    const auto bytes = tactnet::read_file(path_);
    if (bytes.size() < bytes_ ||
        (bytes_ > 0 && bytes[bytes_ - 1] != std::byte{'\n'})) // begun anew by another
        lines_ = bytes_ = 0;
    std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    rest.remove_prefix(bytes_);
    for (std::size_t end = 0; (end = rest.find('\n')) != std::string_view::npos;) {
        const std::string part = fmt::format("line {}", lines_ + 1);
        std::string line(rest.substr(0, end));
        if (tactnet::detail::shows_checksum(line)) // those of earlier versions have none
            line = tactnet::check_json(line, path_.string(), part).text;
        try {
            take(line);
        } catch (const std::exception& error) {
            throw tactnet::file_error(path_.string(), part, expected, fmt::format("'{}'", error.what()));
        }
        ++lines_;
        bytes_ += end + 1;
        rest.remove_prefix(end + 1);
    }
}

void line_file::add(const std::string& text) const {
    make_folder_of(path_);
    try {
        locked_file(path_).add_line(tactnet::with_checksum(text) + '\n');
    } catch (const std::system_error& error) {
        throw tactnet::file_error(path_.string(), "", "to add a line",
                                  fmt::format("'{}'", error.code().message()));
    }
}
