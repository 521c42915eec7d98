#pragma once

// Which images there are, which of them belong together, and a split that a user has fixed.

#include <tactnet/io/images/folder.hpp>
#include <tactnet/training/data/split.hpp>

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

/// Where groups come from: a pattern of names, folders below those of classes, or a table; at most one.
struct group_options {
    std::string pattern, table;
    bool folders = false;
};
/// --group, --group-folders and --table.
void add_group_options(CLI::App& command, group_options& options);

/// The images of a folder, or those of a table, and what is known of them.
struct image_list {
    tactnet::image_folder folder;
    std::vector<std::size_t> groups{};      ///< of each image; empty if there are none
    std::vector<std::string> group_names{}; ///< in natural order
    std::optional<tactnet::data_split> given{};
};

/// The extensions of images.
inline constexpr std::array<std::string_view, 4> image_extensions{".jpg", ".jpeg", ".png", ".npy"};

/// Throws tactnet::file_error and usage_error.
image_list list_images(const std::filesystem::path& folder, const group_options& options);

/// The numbers in file names, after what comes before each, as patterns for --group: "subject(\d+)". Each
/// with the group of every image; only those with two groups or more and at least two images in a group.
struct name_pattern {
    std::string pattern;
    std::vector<std::size_t> groups;
};
std::vector<name_pattern> patterns_of_names(std::span<const std::filesystem::path> paths);
