#pragma once

// Networks that others have trained on photographs, which methods begin with: what a user gives by
// --pretrained, and what stays the same from training to training.

#include "methods/photograph_networks.hpp"

#include <tactnet/runtime/thread_pool.hpp>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

struct image_data;
struct training_settings;
class method;

/// The file that a method needs, for sentences.
struct pretrained_file {
    photograph_network network;
    std::string array; ///< one that must be in it: "features.0.weight"
    std::size_t bytes; ///< that its arrays take in single precision
};

/// Where what was found of images is kept.
struct feature_place {
    std::filesystem::path path;
    bool is_folder; ///< of files that are named by what is in them; else one file, by this name
};

/// Such a file, opened by a method and found to fit it.
class pretrained_weights {
public:
    virtual ~pretrained_weights() = default;
    /// Finds ahead what all trainings on these images have in common, and keeps it in `place`, where another
    /// call goes on however this one was stopped. Tells how far it is. False if it was interrupted. The
    /// images must outlive this.
    virtual bool prepare(const image_data& data, const feature_place& place,
                         tactnet::thread_pool& threads) = 0;
};

/// Throws usage_error when the settings name a file for a method that has no use for it, and when they name
/// none for one that needs it: then with what it must be and how to make it.
void check_pretrained(const method& what, const training_settings& settings);

/// The file in the settings, opened; nothing for a method that needs none. Throws as check_pretrained, and
/// tactnet::file_error.
std::shared_ptr<pretrained_weights> open_pretrained(const method& what, const training_settings& settings);

/// Differs when any byte of the file differs. Found once for each name while the program runs.
std::string pretrained_fingerprint(const std::string& path);
