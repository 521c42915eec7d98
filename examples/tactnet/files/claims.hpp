#pragma once

// The one way to lock: what only one of several programs may do at a time.

#include <filesystem>
#include <vector>

/// Holds names that no other program may hold: files to write, or work to do. The lock of a name is a hidden
/// empty file in the same folder. Claims end with the program, however that ends; the next claim takes over
/// the file of a killed one. Where there are no locks, or the folder takes no file, every claim is granted.
class claims {
public:
    claims() = default;
    claims(const claims&) = delete;
    claims& operator=(const claims&) = delete;
    /// Ends all claims. Folders that were made for them go if nothing came into them.
    ~claims();

    /// Returns false if another holds the name. Makes its folder, if there is none.
    bool take(const std::filesystem::path& name);
    /// Waits up to half a second: what a killed program has started, such as a plot, holds its locks a moment
    /// longer.
    bool take_soon(const std::filesystem::path& name);
    void release(const std::filesystem::path& name);

private:
    struct lock {
        std::filesystem::path file;
        int descriptor;
    };

    std::vector<lock> locks_;
    std::vector<std::filesystem::path> folders_; ///< made here, the outer ones first
};

/// Removes the files in a folder that claims of killed programs have left; those that are held stay.
void remove_abandoned_claims(const std::filesystem::path& folder);
