#include "data/row_store.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/checksum.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <string_view>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace {

constexpr std::string_view format_of_rows = "tactnet rows";

std::string head_of(const tactnet::file_metadata& settings, std::size_t rows, std::size_t size) {
    const nlohmann::ordered_json line{
        {"format", format_of_rows}, {"version", "1"}, {"rows", rows}, {"size", size}, {"settings", settings}};
    return tactnet::with_checksum(line.dump()) + '\n';
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

std::size_t row_store::get(std::span<std::byte> to, std::size_t place) const {
    const ssize_t got = ::pread(descriptor_, to.data(), to.size(), static_cast<off_t>(place));
    if (got < 0)
        fail("a readable file", errno);
    return static_cast<std::size_t>(got);
}

void row_store::put(std::span<const std::byte> from, std::size_t place) {
    const ssize_t written = ::pwrite(descriptor_, from.data(), from.size(), static_cast<off_t>(place));
    if (written != static_cast<ssize_t>(from.size())) // a full disk takes what it can
        fail("to write all bytes", written < 0 ? errno : ENOSPC);
}

row_store::found row_store::look() {
    missing_.clear();
    damaged_ = 0;
    std::string beginning(head_.size(), '\0');
    beginning.resize(get(std::as_writable_bytes(std::span(beginning)), 0));
    if (beginning == head_) {
        const std::uintmax_t bytes = std::filesystem::file_size(path_);
        std::vector<float> row(size_);
        for (std::size_t i = 0; i < rows_; ++i) {
            if (read_row(i, row))
                continue;
            missing_.push_back(i);
            // A program that is killed leaves part of a row at the end.
            damaged_ += place(i + 1) <= bytes ? 1 : 0;
        }
        return found::these_rows;
    }
    const std::string mark = fmt::format("{{\"format\":\"{}\"", format_of_rows);
    // Also a beginning of it, which a killed program leaves.
    const bool known = beginning.starts_with(mark) || mark.starts_with(beginning);
    if (!is_ours_ && !known)
        throw tactnet::file_error(path_.string(), "", "a file of features, or none", "another file");
    if (::ftruncate(descriptor_, 0) != 0)
        fail("a writable file", errno);
    put(std::as_bytes(std::span(head_)), 0);
    for (std::size_t i = 0; i < rows_; ++i)
        missing_.push_back(i);
    return head_.starts_with(beginning) ? found::nothing : found::others;
}

std::uint64_t row_store::checksum(std::size_t row, std::span<const std::byte> values) const {
    return tactnet::xxh64(row).update(head_).update(values).digest();
}

void row_store::write(std::size_t row, std::span<const float> values) {
    const auto numbers = std::as_bytes(values);
    const std::uint64_t sum = checksum(row, numbers);
    std::vector<std::byte> bytes(row_bytes());
    std::ranges::copy(std::as_bytes(std::span(&sum, 1)), std::ranges::copy(numbers, bytes.begin()).out);
    put(bytes, place(row));
}

void row_store::flush() {
    if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOTSUP && errno != EROFS)
        fail("to write all bytes", errno);
}

bool row_store::read_row(std::size_t row, std::span<float> to) const {
    std::vector<std::byte> bytes(row_bytes());
    if (get(bytes, place(row)) != bytes.size())
        return false;
    const auto numbers = std::span(bytes).first(to.size_bytes());
    std::ranges::copy(numbers, std::as_writable_bytes(to).begin());
    std::uint64_t sum = 0;
    std::memcpy(&sum, bytes.data() + numbers.size(), sizeof(sum));
    return sum == checksum(row, numbers);
}

void row_store::read(std::size_t row, std::span<float> to) const {
    if (!read_row(row, to))
        throw tactnet::file_error(path_.string(), fmt::format("row {}", row), "what was written there",
                                  "something else: it is damaged or was changed");
}
