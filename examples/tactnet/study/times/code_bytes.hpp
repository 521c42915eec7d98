#pragma once

// What networks take of a program beside their weights: the table that the target tactnet_program_code_bytes
// writes.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

/// Machine code and constants of the function that recognises a frame.
struct code_size {
    std::string method;
    std::size_t rows, columns;
    std::size_t bits; ///< of a weight
    std::size_t bytes;
};

/// A line is `tactnet6/28x50,32,51000`. Throws tactnet::file_error.
std::vector<code_size> read_code_bytes(const std::filesystem::path& file);
