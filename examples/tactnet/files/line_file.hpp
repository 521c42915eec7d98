#pragma once

// A file of JSON lines with a checksum each, which grows by one line at a time and which several programs may
// share.

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>

class line_file {
public:
    explicit line_file(std::filesystem::path path) : path_(std::move(path)) {}

    const std::filesystem::path& path() const { return path_; }
    /// Calls take(text) for each new whole line, without its checksum. Errors name the line, and that it
    /// should be `expected`. Throws tactnet::file_error, also for what `take` throws and for a line without a
    /// checksum.
    void read_on(const std::string& expected, const std::function<void(const std::string&)>& take);
    /// Adds a line, on the disk when this returns, to be read like those of others. Throws
    /// tactnet::file_error.
    void add(const std::string& text) const;

private:
    std::filesystem::path path_;
    std::size_t lines_ = 0; ///< read so far
    std::size_t bytes_ = 0; ///< that these lines take
};
