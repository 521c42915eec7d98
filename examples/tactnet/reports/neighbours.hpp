#pragma once

// Near-duplicates: what the nearest images say of how honest a test is.

#include "data/image_data.hpp"

#include <tactnet/training/data/neighbours.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// Images of one size, and what is known of them.
struct compared_images {
    tactnet::labelled_images images;
    tactnet::shape size;
    std::span<const std::size_t> groups; ///< empty without
    std::span<const std::filesystem::path> paths;
    std::filesystem::path root; ///< of which paths are shown below
};

/// Whether images of the whole set are near-duplicates of others, and what a random split would overstate; in
/// sentences, each on a line. Empty if not. Without groups, numbers in file names are tried as groups.
std::string neighbours_text(const compared_images& of);
/// The same of a test and its training images.
std::string neighbours_text(const compared_images& of, std::span<const std::size_t> test,
                            std::span<const std::size_t> training);
/// Reports it to a waiting user.
void tell_neighbours(const image_data& data, const tactnet::data_split& split);
