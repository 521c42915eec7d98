#pragma once

// A folder of labelled images, as a training takes it.

#include <tactnet/io/images/folder.hpp>
#include <tactnet/io/images/set.hpp>
#include <tactnet/training/data/labelled_samples.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

struct image_data {
    tactnet::image_set images;
    /// Differs when any pixel, label or class name differs.
    std::string fingerprint;

    /// The same before they were resized, if they had one size then.
    struct {
        std::vector<std::uint8_t> pixels{};
        tactnet::shape size{};
        std::string fingerprint{}; ///< differs when any pixel does
    } taken{};

    /// How images as taken are varied is known by methods.
    tactnet::labelled_images view() const {
        return {images.pixels,
                images.labels,
                images.classes.size(),
                {taken.pixels, taken.size, {images.rows, images.columns}}};
    }
};

/// Loads all images of a folder with one subfolder a class. Those of another size are resized if asked, else
/// refused. Throws tactnet::file_error.
image_data load_data(const std::filesystem::path& folder, std::size_t rows, std::size_t columns, bool resize);

/// One image to recognise, of the size asked for. Throws tactnet::file_error, and usage_error for another
/// size without `resize`.
tactnet::grey_image load_image(const std::filesystem::path& path, std::size_t rows, std::size_t columns,
                               bool resize);

/// Names of classes: subfolders of a folder, or lines of a text file. Throws tactnet::file_error and
/// usage_error.
std::vector<std::string> load_class_names(const std::filesystem::path& path);
