#pragma once

// Two programs that would write the same file.

#include "files/same_file.hpp"

#include <filesystem>
#include <string>
#include <vector>

/// Holds the names of files that this program will write, so that another one that would write them too is
/// refused. Folders for them are made, and go with the claim if nothing came into them. A claim ends with the
/// program, however that ends; of a killed one a hidden empty file stays, which the next claim takes over.
/// Where the file system knows no locks, or the folder takes no file, every claim is granted.
class output_claim {
public:
    /// Throws usage_error if another program has claimed one of them.
    explicit output_claim(const std::vector<named_file>& outputs);
    output_claim(const output_claim&) = delete;
    output_claim& operator=(const output_claim&) = delete;
    ~output_claim() { end(); }

private:
    struct lock {
        std::string file;
        int descriptor;
    };

    void make_folders_of(const std::filesystem::path& file);
    void take(const named_file& output);
    void end() noexcept;

    std::vector<lock> locks_;
    std::vector<std::filesystem::path> folders_; ///< made here, the outer ones first
};
