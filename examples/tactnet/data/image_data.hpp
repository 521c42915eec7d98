#pragma once

// A folder of labelled images, as a training takes it.

#include "data/grouping.hpp"

#include <tactnet/io/images/set.hpp>
#include <tactnet/training/data/labelled_samples.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

struct grey_counts;

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

/// How files become images.
struct image_reading {
    bool resize = false;  ///< those of another size, which are refused otherwise
    std::string sensor{}; ///< a description, whose full scale deeper counts have; refused without

    /// The count that becomes 255; nothing without a description. Throws tactnet::file_error.
    std::optional<double> full_scale() const;
};

/// Counts of 8 bits as they are, deeper ones so that `full_scale` becomes 255. Throws tactnet::file_error
/// where these need it.
tactnet::grey_image in_bytes(const grey_counts& counts, std::optional<double> full_scale,
                             const std::filesystem::path& file);

/// Loads all images of a folder with one subfolder a class, or of a table. Reports folders that are left out.
/// Throws tactnet::file_error and usage_error.
image_data load_data(const std::filesystem::path& folder, std::size_t rows, std::size_t columns,
                     const image_reading& how, const group_options& groups = {});

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

/// One image to recognise, of the size asked for; `full_scale` is that of `how`. Throws tactnet::file_error,
/// and usage_error for another size without `how.resize`.
tactnet::grey_image load_image(const std::filesystem::path& path, std::size_t rows, std::size_t columns,
                               const image_reading& how, std::optional<double> full_scale);

/// Names of classes: subfolders of a folder, or lines of a text file. Throws tactnet::file_error and
/// usage_error.
std::vector<std::string> load_class_names(const std::filesystem::path& path);
