#pragma once

// A network's training, epoch by epoch, with checkpoints.

#include "methods/method.hpp"

#include <cstddef>
#include <filesystem>

struct checkpoint_options {
    std::filesystem::path path;
    double minutes;                  ///< between checkpoints of a running training
    bool resume;                     ///< go on from the one that is there
    tactnet::file_metadata settings; ///< of the training
};

/// Throws usage_error where there is one: hours of work may be in there. With `afresh` it is given up, and
/// only another file of that name is refused. A finished training removes its own.
void check_no_checkpoint(const std::filesystem::path& path, bool afresh);

/// Throws tactnet::file_error unless there is a checkpoint of a training with these settings.
void check_resumable(const checkpoint_options& checkpoint);

/// Keeps a finished training whose results could not be written, and reports it.
void keep_unwritten(network_training& training, const checkpoint_options& checkpoint);

/// Trains until done or interrupted; returns whether it is done.
bool run_epochs(network_training& training, std::size_t epochs, const checkpoint_options& checkpoint);
