#include "files/line_file.hpp"

#include "data/input_file.hpp"
#include "files/output_files.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <functional>
#include <stdexcept>
#include <system_error>
#if defined(_WIN32)
#include <chrono>
#include <cstdio>
#include <fcntl.h>
#include <io.h>
#include <share.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>
#else
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#endif

namespace {

/// The file to add to, which no other program adds to until it is closed, or less than 0.
int open_alone(const std::filesystem::path& path) {
#if defined(_WIN32)
    for (int tries = 0;; ++tries, std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
        const int descriptor = ::_wsopen(path.c_str(), _O_RDWR | _O_CREAT | _O_BINARY | _O_NOINHERIT,
                                         _SH_DENYWR, _S_IREAD | _S_IWRITE);
        if (descriptor >= 0 || errno != EACCES || tries == 1000)
            return descriptor;
    }
#else
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    while (descriptor >= 0 && ::flock(descriptor, LOCK_EX) != 0)
        if (const int error = errno; error != EINTR) {
            ::close(descriptor);
            errno = error;
            return -1;
        }
    return descriptor;
#endif
}

/// Appends a line, on the disk when this returns. Returns 0 or the error number. The beginning of a line that
/// was never finished is cut off first: its writer has failed or is dead, or would hold the file.
int append(int descriptor, std::string_view line) {
    auto end = ::lseek(descriptor, 0, SEEK_END);
    for (char last = 0; end > 0 && ::lseek(descriptor, end - 1, SEEK_SET) >= 0 &&
                        ::read(descriptor, &last, 1) == 1 && last != '\n';)
        --end;
    if (end < 0 || ::ftruncate(descriptor, end) != 0 || ::lseek(descriptor, end, SEEK_SET) < 0)
        return errno;
    const auto written = ::write(descriptor, line.data(), static_cast<unsigned>(line.size()));
    if (written >= 0 && static_cast<std::size_t>(written) != line.size()) // a full disk takes what it can
        return ENOSPC;
#if defined(_WIN32)
    return written < 0 || ::_commit(descriptor) != 0 ? errno : 0;
#else
    return written < 0 || ::fsync(descriptor) != 0 ? errno : 0;
#endif
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
    const int descriptor = open_alone(path_);
    const int error = descriptor < 0 ? errno : append(descriptor, tactnet::with_checksum(text) + '\n');
    if (descriptor >= 0)
        ::close(descriptor); // which ends the lock
    if (error != 0)
        throw tactnet::file_error(path_.string(), "", "to add a line",
                                  fmt::format("'{}'", std::generic_category().message(error)));
}
