#pragma once

#include <tactnet/io/file_error.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

// Labelled images in the usual layout: a folder with one subfolder per class. This header lists them; set.hpp
// loads them.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Whether `a` comes before `b` when runs of digits count as numbers: "key2" before "key10". A strict total
/// order on bytes, independent of the locale; numbers that differ in leading zeros only are put in order by
/// their bytes.
inline bool natural_less(std::string_view a, std::string_view b) noexcept {
    const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
    // Takes a number off the front, without its leading zeros: of any length, so it stays text.
    const auto leading_number = [&](std::string_view& text) {
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
            const std::string_view number_a = leading_number(rest_a), number_b = leading_number(rest_b);
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

/// The content of a folder of images: names only, no file has been opened.
struct image_folder {
    /// An image file and its class.
    struct file {
        std::filesystem::path path;
        /// Index into `classes`.
        std::size_t label;
    };

    std::filesystem::path root;
    /// The names of the subfolders, sorted by their bytes, so that a label means the same on every machine.
    std::vector<std::string> classes;
    /// By class, then in natural order (see natural_less), which is the order of recording.
    std::vector<file> files;
    /// Hidden subfolders with images, which are no classes: ".box" may be meant as one.
    std::vector<std::string> left_out{};
};

/// Where the images of a class are: in its folder, or in folders within that, one for each group of images
/// that belong together, such as those of a person or of an object.
enum class image_folder_layout { classes, groups_in_classes };

/// The file name extensions of images.
inline constexpr std::array<std::string_view, 3> default_image_extensions{".jpg", ".jpeg", ".png"};

namespace detail {

/// In ASCII only, whatever the locale.
inline std::string lower_case(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z')
            c = static_cast<char>(c - 'A' + 'a');
    return text;
}

/// The entries of a folder without the hidden ones, which editors and file managers leave behind; or these.
[[gnu::cold]] inline std::vector<std::filesystem::directory_entry>
visible_entries(const std::filesystem::path& folder, bool hidden = false) {
    std::vector<std::filesystem::directory_entry> entries;
    std::error_code code;
    auto walk = std::filesystem::directory_iterator(folder, code);
    for (; !code && walk != std::filesystem::directory_iterator(); walk.increment(code))
        if (walk->path().filename().string().starts_with('.') == hidden)
            entries.push_back(*walk);
    if (code)
        throw_file_error(folder.string(), {}, {"a readable folder"}, {"'", code.message(), "'"});
    return entries;
}

/// The type of an entry, or of what a link points to. Throws file_error where it is unknown: skipping such an
/// entry would silently drop a class or an image.
[[gnu::cold]] inline std::filesystem::file_type type_of(const std::filesystem::directory_entry& entry) {
    using std::filesystem::file_type;
    std::error_code code, ignored;
    const file_type type = entry.status(code).type();
    if (type == file_type::not_found && entry.is_symlink(ignored))
        throw_file_error(
            entry.path().string(), {}, {"a link to something that is there"},
            {"one to ", in_quotes(std::filesystem::read_symlink(entry.path(), ignored).string())});
    if (type == file_type::not_found || type == file_type::none)
        throw_file_error(entry.path().string(), {}, {"a folder or a file"}, {"'", code.message(), "'"});
    return type;
}

inline bool is_folder(const std::filesystem::directory_entry& entry) {
    return type_of(entry) == std::filesystem::file_type::directory;
}

/// Throws file_error for an entry that is neither a file nor a folder: reading it might wait for ever.
[[gnu::cold]] inline bool is_file(const std::filesystem::directory_entry& entry) {
    using std::filesystem::file_type;
    const file_type type = type_of(entry);
    if (type != file_type::regular && type != file_type::directory)
        throw_file_error(entry.path().string(), {}, {"a regular file"},
                         {type == file_type::fifo     ? "a named pipe"
                          : type == file_type::socket ? "a socket"
                                                      : "a device"});
    return type == file_type::regular;
}

inline bool is_image(const std::filesystem::path& path, std::span<const std::string_view> extensions) {
    return std::find(extensions.begin(), extensions.end(), lower_case(path.extension().string())) !=
           extensions.end();
}

/// The names of hidden folders that hold images. Never throws for what is in them: they are not read.
[[gnu::cold]] inline std::vector<std::string> hidden_folders(const std::filesystem::path& root,
                                                             std::span<const std::string_view> extensions) {
    std::vector<std::string> names;
    for (const auto& entry : visible_entries(root, true)) {
        std::error_code code;
        auto walk = std::filesystem::directory_iterator(entry.path(), code);
        for (; !code && walk != std::filesystem::directory_iterator(); walk.increment(code))
            if (is_image(walk->path(), extensions)) {
                names.push_back(entry.path().filename().string());
                break;
            }
    }
    std::sort(names.begin(), names.end());
    return names;
}

/// The names of the images in a folder, in natural order.
[[gnu::cold]] inline std::vector<std::string> images_in(const std::filesystem::path& folder,
                                                        std::span<const std::string_view> extensions) {
    std::vector<std::string> images;
    std::size_t others = 0;
    for (const auto& entry : visible_entries(folder)) {
        if (is_image(entry.path(), extensions) && is_file(entry))
            images.push_back(entry.path().filename().string());
        else
            ++others;
    }
    if (images.empty()) {
        std::string wanted;
        for (const std::string_view extension : extensions)
            wanted += joined({wanted.empty() ? "" : ", ", extension});
        throw_file_error(folder.string(), {}, {"at least one image (", wanted, ") for this class"},
                         {others == 0 ? "an empty folder" : joined({"none among ", others, " entries"})});
    }
    std::sort(images.begin(), images.end(), natural_less);
    return images;
}

/// The names of the folders in the folder of a class, in natural order.
[[gnu::cold]] inline std::vector<std::string> group_folders_in(const std::filesystem::path& folder) {
    std::vector<std::string> groups;
    for (const auto& entry : visible_entries(folder))
        if (is_folder(entry))
            groups.push_back(entry.path().filename().string());
    if (groups.empty())
        throw_file_error(folder.string(), {}, {"a folder for each group of images of this class"}, {"none"});
    std::sort(groups.begin(), groups.end(), natural_less);
    return groups;
}

} // namespace detail

/// Lists the images in the subfolders of `root`. Hidden entries, files next to the subfolders and folders
/// within them are ignored, unless images are in groups: then the files next to those are. `extensions` are
/// in lower case with the dot; the case of the files does not matter. Links are followed. Throws file_error
/// when there is no such folder, there are fewer than two subfolders, a subfolder has no images, its name is
/// not UTF-8 or has control characters (weight files will store it), a subfolder or an image is a link to
/// nothing, or an image is a pipe, a socket or a device.
[[gnu::cold]] inline image_folder
list_image_folder(const std::filesystem::path& root,
                  std::span<const std::string_view> extensions = default_image_extensions,
                  image_folder_layout layout = image_folder_layout::classes) {
    std::error_code code;
    const auto status = std::filesystem::status(root, code);
    if (!std::filesystem::is_directory(status))
        detail::throw_file_error(root.string(), {}, {"a folder with one subfolder a class"},
                                 {std::filesystem::exists(status) ? "a file" : "nothing of that name"});

    image_folder folder{root, {}, {}};
    const auto entries = detail::visible_entries(root);
    for (const auto& entry : entries)
        if (detail::is_folder(entry))
            folder.classes.push_back(entry.path().filename().string());
    if (folder.classes.empty())
        detail::throw_file_error(root.string(), {}, {"one subfolder a class"},
                                 {entries.empty()
                                      ? "an empty folder"
                                      : detail::joined({entries.size(), " files and no subfolder"})});
    // The same comparison by bytes as of std::string, in the type that sorts images.
    std::sort(
        folder.classes.begin(), folder.classes.end(),
        +[](std::string_view a, std::string_view b) noexcept { return a < b; });
    for (const std::string& name : folder.classes)
        if (!is_utf8(name))
            detail::throw_file_error(root.string(), {"subfolder ", in_quotes(name)}, {"a name in UTF-8"},
                                     {"other bytes"});
        else if (!is_printable(name))
            detail::throw_file_error(root.string(), {"subfolder ", in_quotes(name)},
                                     {"a name without control characters"}, {"some"});
    if (folder.classes.size() == 1)
        detail::throw_file_error(root.string(), {}, {"at least two classes, a subfolder each"},
                                 {"only ", in_quotes(folder.classes.front())});
    for (std::size_t label = 0; label < folder.classes.size(); ++label) {
        const auto subfolder = root / folder.classes[label];
        std::vector<std::filesystem::path> with_images{subfolder};
        if (layout == image_folder_layout::groups_in_classes) {
            with_images.clear();
            for (const std::string& group : detail::group_folders_in(subfolder))
                with_images.push_back(subfolder / group);
        }
        for (const auto& of_group : with_images)
            for (const std::string& name : detail::images_in(of_group, extensions))
                folder.files.push_back({of_group / name, label});
    }
    folder.left_out = detail::hidden_folders(root, extensions);
    return folder;
}

}} // namespace tactnet
