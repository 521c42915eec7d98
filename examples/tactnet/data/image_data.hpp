#pragma once

// A folder of labelled images, as a training takes it.

#include "data/grouping.hpp"

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

    std::filesystem::path root{};
    /// Of each image, as groups were asked for, else empty; and what differs when they do.
    std::vector<std::size_t> groups{};
    std::string groups_fingerprint{};
    std::vector<std::string> group_names{};
    std::optional<tactnet::data_split> given{}; ///< by a table
    std::string given_fingerprint{};

    /// The path of an image below the folder, printable.
    std::string name(std::size_t image) const;
    /// Whether these are the images that the paper's methods were tested on, as its authors publish them.
    bool of_paper() const;

    /// How images as taken are varied is known by methods.
    tactnet::labelled_images view() const {
        return {images.pixels,
                images.labels,
                images.classes.size(),
                {taken.pixels, taken.size, {images.rows, images.columns}}};
    }
};

/// Loads all images of a folder with one subfolder a class, or of a table. Those of another size are resized
/// if asked, else refused. Reports folders that are left out. Throws tactnet::file_error and usage_error.
image_data load_data(const std::filesystem::path& folder, std::size_t rows, std::size_t columns, bool resize,
                     const group_options& groups = {});

/// Reports hidden folders that were left out.
void tell_left_out(const tactnet::image_folder& list);

/// Depends on the pixels of all images and on which are of one class, not on names or order.
class paper_fingerprint {
public:
    explicit paper_fingerprint(std::size_t classes) : sums_(classes) {}
    void add(std::size_t label, std::size_t rows, std::size_t columns, std::span<const std::uint8_t> pixels);
    bool of_paper() const;

private:
    std::vector<std::uint64_t> sums_;
};

/// One image to recognise, of the size asked for. Throws tactnet::file_error, and usage_error for another
/// size without `resize`.
tactnet::grey_image load_image(const std::filesystem::path& path, std::size_t rows, std::size_t columns,
                               bool resize);

/// Names of classes: subfolders of a folder, or lines of a text file. Throws tactnet::file_error and
/// usage_error.
std::vector<std::string> load_class_names(const std::filesystem::path& path);
