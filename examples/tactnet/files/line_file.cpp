#include "files/line_file.hpp"

#include "data/input_file.hpp"
#include "files/output_files.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <fcntl.h>
#include <functional>
#include <stdexcept>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace {

/// Appends a line to a file that other programs may append to as well, on the disk when this returns. Returns
/// 0 or the error number. The beginning of a line that was never finished is cut off first: its writer has
/// failed or is dead, or would hold the lock.
int append(int descriptor, std::string_view line) {
    while (::flock(descriptor, LOCK_EX) != 0)
        if (errno != EINTR)
            return errno;
    struct stat status {};
    if (::fstat(descriptor, &status) != 0)
        return errno;
    off_t end = status.st_size;
    for (char last = 0; end > 0 && ::pread(descriptor, &last, 1, end - 1) == 1 && last != '\n';)
        --end;
    if (::ftruncate(descriptor, end) != 0)
        return errno;
    const ssize_t written = ::write(descriptor, line.data(), line.size());
    if (written >= 0 && written != static_cast<ssize_t>(line.size())) // a full disk takes what it can
        return ENOSPC;
    return written < 0 || ::fsync(descriptor) != 0 ? errno : 0;
}

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
        (bytes_ > 0 && bytes[bytes_ - 1] != std::byte{'\n'})) // another has begun it afresh
        lines_ = bytes_ = 0;
    std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    rest.remove_prefix(bytes_);
    for (std::size_t end = 0; (end = rest.find('\n')) != std::string_view::npos;) {
        const std::string part = fmt::format("line {}", lines_ + 1);
        const auto line = tactnet::check_json(rest.substr(0, end), path_.string(), part);
        try {
            if (line.checksum == tactnet::checksum_state::absent)
                throw std::runtime_error("a line without a checksum");
            take(line.text);
        } catch (const std::exception& error) {
            // The JSON library begins its sentences with a name of its own in brackets.
            std::string_view found = error.what();
            if (found.starts_with("[json.exception."))
                found.remove_prefix(std::min(found.find("] ") + 2, found.size()));
            throw tactnet::file_error(path_.string(), part, expected, fmt::format("'{}'", found));
        }
        ++lines_;
        bytes_ += end + 1;
        rest.remove_prefix(end + 1);
    }
}

void line_file::add(const std::string& text) const {
    make_folder_of(path_);
    const int descriptor = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    const int error = descriptor < 0 ? errno : append(descriptor, tactnet::with_checksum(text) + '\n');
    if (descriptor >= 0)
        ::close(descriptor); // which ends the lock
    if (error != 0)
        throw tactnet::file_error(path_.string(), "", "to add a line",
                                  fmt::format("'{}'", std::generic_category().message(error)));
}
