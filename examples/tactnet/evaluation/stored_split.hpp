#pragma once

// The split of the images that a weight file was trained on, as it says itself.

#include "data/image_data.hpp"

#include <tactnet/io/model_file.hpp>
#include <tactnet/training/data/split.hpp>

#include <string>

/// Throws tactnet::file_error for a file that no training has written, and for other images than those of the
/// training.
tactnet::data_split stored_split(const std::string& file, const tactnet::file_metadata& metadata,
                                 const std::string& folder, const image_data& data);
