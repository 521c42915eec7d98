#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/text.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

// Labelled images as the ecosystem keeps them: a folder with one subfolder a class. Listing and loading are
// apart, and the library decodes nothing itself: the caller passes a function that turns a file into grey
// values.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// An image of 8-bit grey values, row-major, `rows * columns` of them.
struct grey_image {
    std::size_t rows = 0;
    std::size_t columns = 0;
    std::vector<std::uint8_t> pixels;
};

/// What is in a folder of images: names only, nothing has been opened.
struct image_folder {
    struct file {
        std::filesystem::path path;
        /// Index into `classes`.
        std::size_t label;
    };

    std::filesystem::path root;
    /// The names of the subfolders, sorted by their bytes, so that a label means the same on every machine.
    std::vector<std::string> classes;
    /// By class, then in natural order (see natural_less): neighbours here were recorded one after the other.
    std::vector<file> files;
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

/// Whether `a` comes before `b` when runs of digits count as numbers: "key2" before "key10". A strict total
/// order on bytes, independent of the locale; numbers that differ in leading zeros only are put in order by
/// their bytes.
inline bool natural_less(std::string_view a, std::string_view b) noexcept {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    // Takes a number off the front, without its leading zeros: of any length, so it stays text.
    const auto take_number = [&](std::string_view& text) {
        std::size_t end = 0;
        while (end < text.size() && is_digit(text[end]))
            ++end;
        std::string_view number = text.substr(0, end);
        text.remove_prefix(end);
        number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
        return number;
    };
    std::string_view rest_a = a, rest_b = b;
    while (!rest_a.empty() && !rest_b.empty()) {
        if (is_digit(rest_a.front()) && is_digit(rest_b.front())) {
            const std::string_view number_a = take_number(rest_a), number_b = take_number(rest_b);
            if (number_a.size() != number_b.size())
                return number_a.size() < number_b.size();
            if (const int order = number_a.compare(number_b); order != 0)
                return order < 0;
        } else {
            if (rest_a.front() != rest_b.front())
                return static_cast<unsigned char>(rest_a.front()) <
                       static_cast<unsigned char>(rest_b.front());
            rest_a.remove_prefix(1);
            rest_b.remove_prefix(1);
        }
    }
    if (rest_a.empty() != rest_b.empty())
        return rest_a.empty();
    return a < b;
}

/// The file name endings that count as images unless told otherwise.
inline constexpr std::array<std::string_view, 3> default_image_extensions{".jpg", ".jpeg", ".png"};

namespace detail {

inline std::string size_text(std::size_t rows, std::size_t columns) {
    return std::to_string(rows) + " x " + std::to_string(columns) + " pixels (rows x columns)";
}

inline std::string lower_case(std::string text) {
    // ASCII only: the endings are, and the locale must not matter.
    for (char& c : text)
        if (c >= 'A' && c <= 'Z')
            c = static_cast<char>(c - 'A' + 'a');
    return text;
}

/// What is in a folder but for hidden entries, which editors and file managers leave behind.
inline std::vector<std::filesystem::directory_entry> visible_entries(const std::filesystem::path& folder) {
    std::vector<std::filesystem::directory_entry> entries;
    std::error_code code;
    auto walk = std::filesystem::directory_iterator(folder, code);
    for (; !code && walk != std::filesystem::directory_iterator(); walk.increment(code))
        if (!walk->path().filename().string().starts_with('.'))
            entries.push_back(*walk);
    if (code)
        throw file_error(folder.string(), "", "a readable folder", "'" + code.message() + "'");
    return entries;
}

/// What an entry is, or what a link points to. Throws file_error where that cannot be said: to pass over such
/// an entry would drop a class or an image without a word.
inline std::filesystem::file_type type_of(const std::filesystem::directory_entry& entry) {
    using std::filesystem::file_type;
    std::error_code code, ignored;
    const file_type type = entry.status(code).type();
    if (type == file_type::not_found && entry.is_symlink(ignored))
        throw file_error(entry.path().string(), "", "a link to something that is there",
                         "one to " +
                             in_quotes(std::filesystem::read_symlink(entry.path(), ignored).string()));
    if (type == file_type::not_found || type == file_type::none)
        throw file_error(entry.path().string(), "", "a folder or a file", "'" + code.message() + "'");
    return type;
}

inline bool is_folder(const std::filesystem::directory_entry& entry) {
    return type_of(entry) == std::filesystem::file_type::directory;
}

/// Throws file_error for what is neither a file nor a folder: reading it might wait for ever.
inline bool is_file(const std::filesystem::directory_entry& entry) {
    using std::filesystem::file_type;
    const file_type type = type_of(entry);
    if (type != file_type::regular && type != file_type::directory)
        throw file_error(entry.path().string(), "", "a regular file",
                         type == file_type::fifo     ? "a named pipe"
                         : type == file_type::socket ? "a socket"
                                                     : "a device");
    return type == file_type::regular;
}

inline std::vector<std::filesystem::path> images_in(const std::filesystem::path& folder,
                                                    std::span<const std::string_view> extensions) {
    std::vector<std::filesystem::path> images;
    std::size_t others = 0;
    for (const auto& entry : visible_entries(folder)) {
        const std::string extension = lower_case(entry.path().extension().string());
        if (std::ranges::find(extensions, extension) != extensions.end() && is_file(entry))
            images.push_back(entry.path());
        else
            ++others;
    }
    if (images.empty()) {
        std::string wanted;
        for (const std::string_view extension : extensions)
            wanted += (wanted.empty() ? "" : ", ") + std::string(extension);
        throw file_error(folder.string(), "", "at least one image (" + wanted + ") for this class",
                         others == 0 ? "an empty folder"
                                     : "none among " + std::to_string(others) + " entries");
    }
    std::ranges::sort(images, [](const auto& a, const auto& b) {
        return natural_less(a.filename().string(), b.filename().string());
    });
    return images;
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

/// Lists the images in the subfolders of `root`. Hidden entries, files beside the subfolders and folders
/// within them are passed over. `extensions` in lower case with the dot; the files' case does not matter.
/// Links are followed. Throws file_error when there is no such folder, there are fewer than two subfolders, a
/// subfolder has no images, its name is not UTF-8 (it will be stored in weight files, which must be), what
/// would be a subfolder or an image is a link to nothing, or an image is a pipe, a socket or a device.
inline image_folder
list_image_folder(const std::filesystem::path& root,
                  std::span<const std::string_view> extensions = default_image_extensions) {
    std::error_code code;
    const auto status = std::filesystem::status(root, code);
    if (!std::filesystem::exists(status))
        throw file_error(root.string(), "", "a folder with one subfolder a class", "nothing of that name");
    if (!std::filesystem::is_directory(status))
        throw file_error(root.string(), "", "a folder with one subfolder a class", "a file");

    image_folder folder{root, {}, {}};
    const auto entries = detail::visible_entries(root);
    for (const auto& entry : entries)
        if (detail::is_folder(entry))
            folder.classes.push_back(entry.path().filename().string());
    if (folder.classes.empty())
        throw file_error(root.string(), "", "one subfolder a class",
                         entries.empty() ? "an empty folder"
                                         : std::to_string(entries.size()) + " files and no subfolder");
    std::ranges::sort(folder.classes);
    for (const std::string& name : folder.classes)
        if (!is_utf8(name))
            throw file_error(root.string(), "subfolder " + in_quotes(name), "a name in UTF-8", "other bytes");
    if (folder.classes.size() == 1)
        throw file_error(root.string(), "", "at least two classes, a subfolder each",
                         "only " + in_quotes(folder.classes.front()));
    for (std::size_t label = 0; label < folder.classes.size(); ++label)
        for (auto& path : detail::images_in(root / folder.classes[label], extensions))
            folder.files.push_back({std::move(path), label});
    return folder;
}

/// Loads all images, each of which must have `rows` x `columns` pixels. `decode(path)` gives a grey_image or
/// throws. Throws file_error with the name of the first image of another size.
template <class Decoder>
    requires std::is_invocable_r_v<grey_image, Decoder&, const std::filesystem::path&> image_set
    load_images(const image_folder& folder, std::size_t rows, std::size_t columns, Decoder decode) {
        return detail::load_images(
            folder, rows, columns, decode,
            [&](const grey_image& image, const std::filesystem::path& path) -> grey_image {
                throw file_error(path.string(), "", detail::size_text(rows, columns),
                                 detail::size_text(image.rows, image.columns));
            });
    }

/// The same, but `resize(image)` brings images of another size to `rows` x `columns`.
template <class Decoder, class Resizer>
    requires std::is_invocable_r_v<grey_image, Decoder&, const std::filesystem::path&> &&
        std::is_invocable_r_v<grey_image, Resizer&, grey_image>
            image_set load_images(const image_folder& folder, std::size_t rows, std::size_t columns,
                                  Decoder decode, Resizer resize) {
        return detail::load_images(folder, rows, columns, decode,
                                   [&](grey_image image, const std::filesystem::path&) -> grey_image {
                                       return resize(std::move(image));
                                   });
    }

} // namespace TACTNET_ARCH
} // namespace tactnet
