#pragma once

// Before any work is done: no output may take the place of an input or of another output.

#include <filesystem>
#include <string>
#include <vector>

/// A path with the option that a user gave it by.
struct named_file {
    std::string option;
    std::filesystem::path path;
};

/// Whether two names are or would be the same file, also by links, whether or not there is one yet.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Throws usage_error where an output is the same file as an input or another output.
void check_distinct(const std::vector<named_file>& inputs, const std::vector<named_file>& outputs);

/// Throws usage_error where an output would lie in a subfolder of `data`, which is a class of images:
/// pictures of results would become images of it.
void check_outside_classes(const std::filesystem::path& data, const std::vector<named_file>& outputs);
