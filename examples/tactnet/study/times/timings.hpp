#pragma once

// Latencies that were measured, in a file of JSON lines: each by method, size, processor and program, since
// those of another machine are not to be mixed in.

#include "files/line_file.hpp"
#include "study/times/latency.hpp"

#include <tactnet/io/model_file.hpp>

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

class timing_list {
public:
    /// Reads what there is. Throws tactnet::file_error.
    explicit timing_list(const std::filesystem::path& path);

    /// Takes over what other programs have added since. Throws tactnet::file_error.
    void read_on();
    /// With weights of so many bits, by this program on this machine, or nothing.
    const frame_latency* find(const method& what, std::size_t bits) const;
    /// By this version and compiler on this machine: by the name of the instruction set that a program was
    /// compiled for, this one's among them.
    std::map<std::string, frame_latency> by_instruction_set(const method& what, std::size_t bits) const;
    void add(const method& what, std::size_t bits, const frame_latency& found);

private:
    line_file file_;
    std::map<tactnet::file_metadata, frame_latency> all_;
};

/// The compiler and its version.
std::string compiler_name();
