#pragma once

// The same networks run by other libraries: the table that benchmark_inference writes (--table), for a study
// to draw its times beside its own.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

/// Another library's time for a network of a study. It has that network's accuracy, since it is the same.
struct peer_time {
    std::string peer; ///< as the column is named: "onednn"
    std::string method;
    std::size_t rows, columns;
    double microseconds;     ///< a frame alone
    std::size_t bits = 32;   ///< of a weight
    std::string processor{}; ///< that it was measured on; empty where the table does not say
};

/// Those of single frames: a line is `tactnet6/28x50,1,…`, and each column `NAME_us` is a peer but those of
/// tactnet itself, `NAME_8bit_us` one in 8 bits; `nan` is one that did not run. Throws tactnet::file_error.
std::vector<peer_time> read_peer_times(const std::filesystem::path& file);
