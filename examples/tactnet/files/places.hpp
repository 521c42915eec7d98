#pragma once

// The files that a command will write, looked at before it does any work.

#include "files/same_file.hpp"

#include <filesystem>
#include <string>
#include <vector>

/// Throws usage_error unless all outputs can be written, are neither inputs nor each other, and lie outside
/// the classes of the images in `data`, if that is a name.
void check_places(const std::vector<named_file>& inputs, const std::vector<named_file>& outputs,
                  const std::filesystem::path& data = {});

/// Throws usage_error where one is a device or a pipe: other files go beside it, and some are removed.
void check_regular(const std::vector<named_file>& outputs);

/// What drawing a picture leaves: STEM.csv and others.
std::vector<named_file> picture_files(const std::string& option, const std::filesystem::path& stem);

/// Removes what killed programs left half-written in the folders of the outputs.
void tidy_folders_of(const std::vector<named_file>& outputs);
