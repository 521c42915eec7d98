#include "data/folder_check.hpp"

#include "data/input_file.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/images/set.hpp>

#include <algorithm>
#include <decode_image.hpp>
#include <map>
#include <set>
#include <system_error>
#include <tuple>

namespace {

using pixel_key = std::tuple<std::size_t, std::size_t, std::vector<std::uint8_t>>;

checked_image checked(const tactnet::image_folder::file& file, tactnet::grey_image& image) {
    checked_image found{.path = file.path, .label = file.label};
    try {
        check_no_device(file.path);
        image = decode_image(file.path);
    } catch (const tactnet::file_error& error) {
        found.unreadable = "expected " + error.expected() + ", found " + error.found();
        return found;
    }
    found.rows = image.rows, found.columns = image.columns;
    found.pressed =
        static_cast<std::size_t>(std::ranges::count_if(image.pixels, [](std::uint8_t p) { return p > 0; }));
    found.full = static_cast<std::size_t>(std::ranges::count(image.pixels, std::uint8_t{255}));
    found.one_value =
        std::ranges::all_of(image.pixels, [&](std::uint8_t p) { return p == image.pixels.front(); });
    fingerprint print;
    print.add(image.rows);
    print.add(image.columns);
    print.mix_all(image.pixels);
    found.pixels = print.value();
    return found;
}

/// Files below a folder that are not among the images, but for hidden ones.
std::vector<std::filesystem::path> others_in(const std::filesystem::path& folder,
                                             const tactnet::image_folder& list) {
    std::set<std::filesystem::path> images;
    for (const auto& file : list.files)
        images.insert(file.path);
    std::vector<std::filesystem::path> others;
    std::error_code code;
    auto walk = std::filesystem::recursive_directory_iterator(folder, code);
    for (; !code && walk != std::filesystem::recursive_directory_iterator(); walk.increment(code)) {
        std::error_code ignored;
        if (walk->path().filename().string().starts_with('.'))
            walk.disable_recursion_pending();
        else if (!walk->is_directory(ignored) && !images.contains(walk->path()))
            others.push_back(walk->path());
    }
    std::ranges::sort(others);
    return others;
}

} // namespace

std::uint64_t folder_check::fingerprint() const {
    std::vector<std::uint64_t> of_classes(classes.size());
    for (const checked_image& image : images)
        of_classes[image.label] += image.pixels; // in any order
    std::uint64_t all = 0;
    for (const std::uint64_t sum : of_classes) {
        ::fingerprint print;
        print.add(sum);
        all += print.value();
    }
    return all;
}

folder_check check_folder(const std::filesystem::path& folder) {
    const tactnet::image_folder list = tactnet::list_image_folder(folder);
    folder_check check{.classes = list.classes};
    std::map<pixel_key, std::size_t> first;
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> sizes;
    for (const auto& file : list.files) {
        tactnet::grey_image image;
        const checked_image& found = check.images.emplace_back(checked(file, image));
        if (!found.readable())
            continue;
        ++sizes[{found.rows, found.columns}];
        if (found.one_value)
            continue;
        const std::size_t index = check.images.size() - 1;
        const auto [same, is_new] =
            first.try_emplace({image.rows, image.columns, std::move(image.pixels)}, index);
        if (!is_new)
            check.copies.emplace_back(same->second, index);
    }
    if (!sizes.empty())
        std::tie(check.rows, check.columns) =
            std::ranges::max_element(sizes, {}, [](const auto& size) { return size.second; })->first;
    check.passed_over = others_in(folder, list);
    return check;
}
