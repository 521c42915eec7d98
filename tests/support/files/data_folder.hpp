#pragma once

// Recordings that do not belong to the project: the folder that TACTNET_DATA names, or the usual one next to
// the sources.

#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

namespace support {

/// Set when data are missing: the program then ends with the status of a skipped test, if nothing failed.
inline bool data_missing = false;

/// The file or folder of that name among the data, or nothing: the test then returns at once.
inline std::optional<std::filesystem::path> find_data(const std::string& name) {
    const char* given = std::getenv("TACTNET_DATA");
    const std::filesystem::path root =
        given != nullptr ? std::filesystem::path(given)
                         : std::filesystem::path(TACTNET_SOURCE_DIR).parent_path() / "shared" / "data";
    std::error_code code;
    if (std::filesystem::exists(root / name, code))
        return root / name;
    data_missing = true;
    MESSAGE("skipped: there is no " << name << " in " << root.string() << " (set TACTNET_DATA)");
    return std::nullopt;
}

} // namespace support
