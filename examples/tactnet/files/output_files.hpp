#pragma once

// The files that a command will write, checked before it does any work.

#include <filesystem>
#include <string>
#include <vector>

/// A path with the option that a user gave it by.
struct named_file {
    std::string option;
    std::filesystem::path path;
};

/// Throws usage_error unless all outputs can be written, are neither inputs nor each other, also by links,
/// and lie outside the classes of images in `data`. Then removes what killed programs have left in their
/// folders, and reports those of which several levels are missing.
void check_outputs(const std::vector<named_file>& inputs, const std::vector<named_file>& outputs,
                   const std::filesystem::path& data = {});

/// Throws usage_error for devices and pipes: other files are written next to them, and some are removed.
void check_regular(const std::vector<named_file>& outputs);

/// Adds what drawing a picture leaves: STEM.csv and STEM.png.
void add_picture(std::vector<named_file>& outputs, const std::string& option,
                 const std::filesystem::path& stem);

/// Makes the folder of a file, if there is none, and removes what killed programs have left in it. Throws
/// usage_error.
void make_folder_of(const std::filesystem::path& path);
