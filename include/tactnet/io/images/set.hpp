#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/images/folder.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

// The images of a folder in memory. The library contains no decoder: the caller passes a function that
// decodes a file into grey values.

namespace tactnet { inline namespace TACTNET_ARCH {

/// An image of 8-bit grey values, row-major, `rows * columns` of them.
struct grey_image {
    std::size_t rows = 0;
    std::size_t columns = 0;
    std::vector<std::uint8_t> pixels;
};

/// Images of one size with their labels.
struct image_set {
    std::size_t rows = 0;
    std::size_t columns = 0;
    /// Image after image, each row-major: `labels.size() * rows * columns` values.
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels;
    std::vector<std::string> classes;
    std::vector<std::filesystem::path> paths;

    std::size_t size() const noexcept { return labels.size(); }
    std::span<const std::uint8_t> image(std::size_t index) const {
        return std::span(pixels).subspan(index * rows * columns, rows * columns);
    }
};

namespace detail {

[[gnu::cold]] inline std::string size_text(std::size_t rows, std::size_t columns) {
    return joined({rows, " x ", columns, " pixels (rows x columns)"});
}

template <class Decoder, class Fit>
image_set load_images(const image_folder& folder, std::size_t rows, std::size_t columns, Decoder& decode,
                      Fit fit) {
    image_set set{rows, columns, {}, {}, folder.classes, {}};
    for (const auto& [path, label] : folder.files) {
        grey_image image = decode(path);
        if (image.rows != rows || image.columns != columns)
            image = fit(std::move(image), path);
        if (image.rows != rows || image.columns != columns || image.pixels.size() != rows * columns)
            throw std::logic_error(
                "tactnet: a decoder or resizer gave an image of another size than it says");
        set.pixels.insert(set.pixels.end(), image.pixels.begin(), image.pixels.end());
        set.labels.push_back(label);
        set.paths.push_back(path);
    }
    return set;
}

} // namespace detail

/// Loads all images, each of which must have `rows` x `columns` pixels. `decode(path)` returns a grey_image
/// or throws. Throws file_error with the name of the first image of another size.
template <class Decoder>
    requires std::is_invocable_r_v<grey_image, Decoder&, const std::filesystem::path&>
image_set load_images(const image_folder& folder, std::size_t rows, std::size_t columns, Decoder decode) {
    return detail::load_images(folder, rows, columns, decode,
                               [&](const grey_image& image, const std::filesystem::path& path) -> grey_image {
                                   throw file_error(path.string(), "", detail::size_text(rows, columns),
                                                    detail::size_text(image.rows, image.columns));
                               });
}

/// Loads all images; `resize(image)` returns images of another size in `rows` x `columns` pixels.
template <class Decoder, class Resizer>
    requires std::is_invocable_r_v<grey_image, Decoder&, const std::filesystem::path&> &&
             std::is_invocable_r_v<grey_image, Resizer&, grey_image>
image_set load_images(const image_folder& folder, std::size_t rows, std::size_t columns, Decoder decode,
                      Resizer resize) {
    return detail::load_images(folder, rows, columns, decode,
                               [&](grey_image image, const std::filesystem::path&) -> grey_image {
                                   return resize(std::move(image));
                               });
}

}} // namespace tactnet
