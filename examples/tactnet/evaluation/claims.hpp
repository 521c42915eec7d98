#pragma once

// Who does which training, where several programs share a folder of results.

#include <tactnet/io/model_file.hpp>

#include <filesystem>

/// Claims on trainings, which end with the program however it ends. Where the file system knows no locks, or
/// the file cannot be written, every claim is granted.
class training_claims {
public:
    /// The locks are those of this file, which stays empty.
    explicit training_claims(const std::filesystem::path& path);
    training_claims(const training_claims&) = delete;
    training_claims& operator=(const training_claims&) = delete;
    ~training_claims();

    /// False if another program has the training with these settings.
    bool take(const tactnet::file_metadata& settings);
    void release(const tactnet::file_metadata& settings);

private:
    int descriptor_;
};
