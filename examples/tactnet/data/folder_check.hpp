#pragma once

// What there is to say of a folder of images before anything is trained on it.

#include <tactnet/io/images/folder.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

struct checked_image {
    std::filesystem::path path;
    std::size_t label = 0;
    std::string unreadable{}; ///< why it cannot be read; then nothing of what follows is known
    std::size_t rows = 0, columns = 0;
    std::size_t pressed = 0, full = 0; ///< tactels above 0, and at 255, where a sensor saturates
    bool one_value = false;            ///< all tactels are alike
    std::uint64_t pixels = 0;          ///< their fingerprint

    bool readable() const { return unreadable.empty(); }
    /// No contact, or a sensor that does not work.
    bool empty() const { return readable() && one_value && full == 0; }
    /// At least half of the pressed tactels are at the sensor's maximum.
    bool saturated() const { return readable() && full > 0 && 2 * full >= pressed; }
};

struct folder_check {
    std::vector<std::string> classes{};
    std::vector<checked_image> images{}; ///< by class, then in natural order
    /// Of images with the same pixels, but for empty ones: the first, and each other one.
    std::vector<std::pair<std::size_t, std::size_t>> copies{};
    std::vector<std::filesystem::path> passed_over{}; ///< files that are no image of a class
    std::size_t rows = 0, columns = 0;                ///< of most images; 0 if none can be read

    bool within_a_class(const std::pair<std::size_t, std::size_t>& copy) const {
        return images[copy.first].label == images[copy.second].label;
    }
    /// Depends on the pixels of all images and on which are of one class, not on names or order.
    std::uint64_t fingerprint() const;
};

/// Reads all images of a folder with one subfolder a class. Throws tactnet::file_error where it is no such
/// folder.
folder_check check_folder(const std::filesystem::path& folder);

/// The images that the paper's methods were tested on, as its authors publish them.
struct paper_images {
    static constexpr std::size_t images = 1100, classes = 22, rows = 28, columns = 50, copies = 5;
    static constexpr std::uint64_t fingerprint = 0x587e7229c6307ee5;
    static constexpr const char* source =
        "github.com/TaISLab/CNN-based-Methods-for-Tactile-Object-Recognition, "
        "with the paper doi 10.1109/JSEN.2019.2912968";
};
