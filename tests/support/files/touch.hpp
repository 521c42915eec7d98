#pragma once

#include <tactnet/io/write_file.hpp>

#include <filesystem>
#include <string_view>

namespace support {

/// Makes a file, and the folders around it.
inline void touch(const std::filesystem::path& path, std::string_view text = "") {
    std::filesystem::create_directories(path.parent_path());
    tactnet::write_file(path, text);
}

} // namespace support
