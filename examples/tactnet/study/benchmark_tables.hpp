#pragma once

// Tables of networks that a benchmark or the build writes, as text with commas: a head, and lines that begin
// with a network and its size, `tactnet6/28x50,…`.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

/// Another library's time for a network of a study. It has that network's accuracy, since it is the same.
struct peer_time {
    std::string peer; ///< as the column is named: "onednn"
    std::string method;
    std::size_t rows, columns;
    double microseconds;     ///< of a single frame
    std::size_t bits = 32;   ///< of a weight
    std::string processor{}; ///< that it was measured on; empty where the table does not say
};

/// Reads the times of single frames from the table that benchmark_inference writes (--table): a line is
/// `tactnet6/28x50,1,…`, and each column `NAME_us` is a peer except tactnet itself, `NAME_8bit_us` one in 8
/// bits; `nan` is one that did not run. Throws tactnet::file_error.
std::vector<peer_time> read_peer_times(const std::filesystem::path& file);

/// Machine code and constants of the function that recognises a frame.
struct code_size {
    std::string method;
    std::size_t rows, columns;
    std::size_t bits; ///< of a weight
    std::size_t bytes;
};

/// Reads the table that the target tactnet_program_code_bytes writes: a line is `tactnet6/28x50,32,51000`.
/// Throws tactnet::file_error.
std::vector<code_size> read_code_bytes(const std::filesystem::path& file);
