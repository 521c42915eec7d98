#include "data/row_store.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/checksum.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <fcntl.h>
#include <string_view>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace {

constexpr std::string_view format = "tactnet rows";

std::string head_of(const tactnet::file_metadata& settings, std::size_t rows, std::size_t size) {
    nlohmann::ordered_json line;
    line["format"] = format;
    line["version"] = "1";
    line["rows"] = rows;
    line["size"] = size;
    line["settings"] = settings;
    return tactnet::with_checksum(line.dump()) + '\n';
}

/// All bytes at a place; fewer at the end of the file. Returns how many, or −1.
ssize_t read_all(int descriptor, std::span<std::byte> to, std::int64_t place) {
    std::size_t done = 0;
    while (done < to.size()) {
        const ssize_t got = ::pread(descriptor, to.data() + done, to.size() - done,
                                    static_cast<off_t>(place) + static_cast<off_t>(done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return -1;
        if (got == 0)
            break;
        done += static_cast<std::size_t>(got);
    }
    return static_cast<ssize_t>(done);
}

/// Returns 0 or the error number.
int write_all(int descriptor, std::span<const std::byte> from, std::int64_t place) {
    for (std::size_t done = 0; done < from.size();) {
        const ssize_t written = ::pwrite(descriptor, from.data() + done, from.size() - done,
                                         static_cast<off_t>(place) + static_cast<off_t>(done));
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return written < 0 ? errno : ENOSPC;
        done += static_cast<std::size_t>(written);
    }
    return 0;
}

std::span<const std::byte> bytes_of(std::string_view text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

} // namespace

row_store::row_store(const std::filesystem::path& path, const tactnet::file_metadata& settings,
                     std::size_t rows, std::size_t size, bool is_ours)
    : path_(path),
      head_(head_of(settings, rows, size)),
      rows_(rows),
      size_(size),
      is_ours_(is_ours),
      descriptor_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666)) {
    struct stat status {};
    if (descriptor_ >= 0 && ::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode))
        return;
    const int error = descriptor_ < 0 ? errno : EINVAL;
    if (descriptor_ >= 0)
        ::close(descriptor_);
    fail("a file to keep features in", error);
}

row_store::~row_store() {
    ::close(descriptor_);
}

void row_store::fail(const char* expected, int error) const {
    throw tactnet::file_error(path_.string(), "", expected,
                              fmt::format("'{}'", std::generic_category().message(error)));
}

bool row_store::claim() {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0)
        return true;
    return errno != EWOULDBLOCK && errno != EINTR; // where the file system knows no locks
}

void row_store::release() {
    ::flock(descriptor_, LOCK_UN);
}

row_store::found row_store::look() {
    missing_.clear();
    damaged_ = 0;
    std::string beginning(head_.size(), '\0');
    const ssize_t got = read_all(descriptor_, std::as_writable_bytes(std::span(beginning)), 0);
    if (got < 0)
        fail("a readable file", errno);
    beginning.resize(static_cast<std::size_t>(got));
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0)
        fail("a readable file", errno);
    if (beginning == head_) {
        std::vector<float> row(size_);
        for (std::size_t i = 0; i < rows_; ++i) {
            if (read_row(i, row))
                continue;
            missing_.push_back(i);
            // A program that is killed leaves part of a row at the end.
            damaged_ += place(i + 1) <= status.st_size ? 1 : 0;
        }
        return found::these_rows;
    }
    const std::string mark = fmt::format("{{\"format\":\"{}\"", format);
    // Also a beginning of it, which a killed program leaves.
    const bool known = beginning.starts_with(mark) || mark.starts_with(beginning);
    if (!is_ours_ && !known)
        throw tactnet::file_error(path_.string(), "", "a file of features, or none", "another file");
    if (::ftruncate(descriptor_, 0) != 0)
        fail("a writable file", errno);
    if (const int error = write_all(descriptor_, bytes_of(head_), 0); error != 0)
        fail("to write all bytes", error);
    for (std::size_t i = 0; i < rows_; ++i)
        missing_.push_back(i);
    return head_.starts_with(beginning) ? found::nothing : found::others;
}

std::int64_t row_store::place(std::size_t row) const {
    return static_cast<std::int64_t>(head_.size() + row * (size_ * sizeof(float) + sizeof(std::uint64_t)));
}

std::uint64_t row_store::checksum(std::size_t row, std::span<const float> values) const {
    return tactnet::xxh64(row).update(head_).update(std::as_bytes(values)).digest();
}

void row_store::write(std::size_t row, std::span<const float> values) {
    const std::uint64_t sum = checksum(row, values);
    int error = write_all(descriptor_, std::as_bytes(values), place(row));
    if (error == 0)
        error = write_all(descriptor_, std::as_bytes(std::span(&sum, 1)),
                          place(row) + static_cast<std::int64_t>(values.size_bytes()));
    if (error != 0)
        fail("to write all bytes", error);
}

void row_store::flush() {
    if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOTSUP && errno != EROFS)
        fail("to write all bytes", errno);
}

bool row_store::read_row(std::size_t row, std::span<float> to) const {
    std::uint64_t sum = 0;
    const auto size = static_cast<ssize_t>(to.size_bytes());
    const ssize_t values = read_all(descriptor_, std::as_writable_bytes(to), place(row));
    const ssize_t sums = read_all(descriptor_, std::as_writable_bytes(std::span(&sum, 1)), place(row) + size);
    if (values < 0 || sums < 0)
        fail("a readable file", errno);
    return values == size && sums == static_cast<ssize_t>(sizeof(sum)) && sum == checksum(row, to);
}

void row_store::read(std::size_t row, std::span<float> to) const {
    if (!read_row(row, to))
        throw tactnet::file_error(path_.string(), fmt::format("row {}", row), "what was written there",
                                  "something else: it is damaged or was changed");
}
