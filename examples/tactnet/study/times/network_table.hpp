#pragma once

// Tables that a benchmark or a build writes of networks, as text with commas: a head, and lines that begin
// with a network and its size, `tactnet6/28x50,…`.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// A line, whose cells are as many as the head's.
struct network_line {
    std::string method;
    std::size_t rows, columns;
    std::vector<std::string> cells;
    std::size_t number; ///< in the file, from 1 on
};

class network_table {
public:
    /// Reads a whole file of at most 1 MiB. The head has to begin with `head`, columns `of` something. Throws
    /// tactnet::file_error.
    network_table(std::filesystem::path file, std::string_view head, std::string_view of);

    const std::vector<std::string>& names() const { return names_; }
    const std::vector<network_line>& lines() const { return lines_; }
    /// Throws tactnet::file_error with the line, and the beginning of what was found.
    [[noreturn]] void refuse(std::size_t line, const std::string& expected, std::string_view found) const;

private:
    std::filesystem::path file_;
    std::vector<std::string> names_;
    std::vector<network_line> lines_;
};
