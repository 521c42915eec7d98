#pragma once

// A network's training, epoch by epoch, with checkpoints.

#include "methods/method.hpp"

#include <cstddef>
#include <filesystem>

struct checkpoint_options {
    std::filesystem::path path;
    double minutes; ///< between checkpoints of a running training
    bool resume;    ///< go on from the one that is there
};

/// Throws usage_error where there is one: hours of work may be in there. A finished training leaves none.
void check_no_checkpoint(const std::filesystem::path& path);

/// Throws usage_error where there is a file that is no checkpoint: a training that is done removes it.
void check_given_up(const std::filesystem::path& path);

/// Throws tactnet::file_error unless there is a checkpoint of a training with these settings.
void check_resumable(const std::filesystem::path& path, const tactnet::file_metadata& settings);

/// Keeps a finished training whose results could not be written, and tells about it.
void keep_unwritten(network_training& training, const checkpoint_options& checkpoint,
                    const tactnet::file_metadata& settings);

/// Trains until done or interrupted; tells whether it is done. `settings` are those of the training.
bool run_epochs(network_training& training, std::size_t epochs, const checkpoint_options& checkpoint,
                const tactnet::file_metadata& settings);
