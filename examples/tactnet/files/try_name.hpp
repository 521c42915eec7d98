#pragma once

#include <filesystem>

/// Throws usage_error unless the file system takes a file of this name there, in folders that need not exist
/// yet. Nothing of that name is made: another program could open it before it is gone.
void try_name(const std::filesystem::path& path);

/// Removes from a folder what killed programs left of such trials.
void remove_abandoned_trials(const std::filesystem::path& folder);
