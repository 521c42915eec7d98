// tactnet check: a folder of images as the program reads it, and what is wrong with it.

#include "commands/commands.hpp"
#include "data/image_data.hpp"
#include "data/input_file.hpp"
#include "methods/training_settings.hpp"
#include "reports/neighbours.hpp"

#include <decode_image.hpp>
#include <set>

namespace {

constexpr const char* paper_images = "the paper's 1 100 images of 22 classes, 28x50, of which 5 are copies "
                                     "(github.com/TaISLab/CNN-based-Methods-for-Tactile-Object-Recognition, "
                                     "with the paper doi 10.1109/JSEN.2019.2912968)";

struct checked_image {
    std::string name; ///< below the folder, printable
    std::size_t label;
    std::string size = "unreadable";
    std::string refused{};             ///< why trainings do not take it
    grey_counts counts{};              ///< of the file; none where it cannot be read
    tactnet::grey_image image{};       ///< what trainings take
    double full_scale = 255;           ///< the largest count that the sensor gives
    std::size_t pressed = 0, full = 0; ///< tactels above 0 and at full scale
    bool one_value = true;             ///< all tactels have the same
};

std::string name_in(const std::filesystem::path& folder, const std::filesystem::path& path) {
    return printable(path.lexically_relative(folder).string());
}

std::vector<checked_image> read_images(const tactnet::image_folder& list, const std::filesystem::path& folder,
                                       std::optional<double> full_scale) {
    std::vector<checked_image> images;
    for (const auto& file : list.files) {
        checked_image& found = images.emplace_back(checked_image{name_in(folder, file.path), file.label});
        try {
            check_no_device(file.path);
            found.counts = decode_counts(file.path);
            found.size = fmt::format("{}x{}", found.counts.rows, found.counts.columns);
            found.image = in_bytes(found.counts, full_scale, file.path);
        } catch (const tactnet::file_error& error) {
            found.refused = "expected " + error.expected() + ", found " + error.found();
        }
        if (found.counts.largest > 255)
            found.full_scale = full_scale.value_or(found.counts.largest);
        for (const float count : found.counts.pixels) {
            found.pressed += count > 0;
            found.full += count >= static_cast<float>(found.full_scale);
            found.one_value = found.one_value && count == found.counts.pixels.front();
        }
    }
    return images;
}

/// The size of most images.
std::string usual_size(const std::vector<checked_image>& images) {
    std::map<std::string, std::size_t> sizes{{"", 0}};
    for (const checked_image& found : images)
        sizes[found.size] += !found.counts.pixels.empty();
    return std::ranges::max_element(sizes, {}, [](const auto& size) { return size.second; })->first;
}

/// A line of the table.
struct counts {
    std::string name;
    std::size_t images = 0, copies = 0, full = 0; ///< `full`: those with a tactel at full scale
    std::vector<std::string> sizes{};
};

/// What is wrong with an image by itself. Each in a line.
std::vector<std::string> problems_of(const checked_image& found, const std::string& usual) {
    std::vector<std::string> problems;
    if (found.size != usual)
        problems.push_back(
            fmt::format("expected {} as most images, or --resize in training, found {}", usual, found.size));
    if (found.one_value && found.full == 0)
        problems.emplace_back("expected a touch, found the same value in all tactels");
    if (found.full > 0 && 2 * found.full >= found.pressed)
        problems.push_back(
            fmt::format("expected pressures that the sensor can tell, found {} of {} pressed tactels at {}",
                        found.full, found.pressed, found.full_scale));
    return problems;
}

/// Files below a folder that are not among the images, but for hidden ones.
std::vector<std::filesystem::path> others_in(const std::filesystem::path& folder,
                                             const tactnet::image_folder& list) {
    std::set<std::filesystem::path> images;
    for (const auto& file : list.files)
        images.insert(file.path);
    std::vector<std::filesystem::path> others;
    std::error_code code, ignored;
    auto walk = std::filesystem::recursive_directory_iterator(folder, code);
    for (; !code && walk != std::filesystem::recursive_directory_iterator(); walk.increment(code))
        if (walk->path().filename().string().starts_with('.'))
            walk.disable_recursion_pending();
        else if (!walk->is_directory(ignored) && !images.contains(walk->path()))
            others.push_back(walk->path());
    std::ranges::sort(others);
    return others;
}

/// Classes of too few images for a test to say much of them, and classes of many that crowd out others. Each
/// in a line.
std::vector<std::string> doubts_of(std::span<const counts> classes) {
    constexpr std::size_t few = 20, times = 3; // 20 % of 20 are 4 images to test
    std::vector<std::string> doubts;
    const std::size_t most = std::ranges::max(classes, {}, &counts::images).images;
    for (const counts& of : classes)
        if (of.images < few && times * of.images < most)
            doubts.push_back(
                fmt::format("{}: expected {} images or more and a third of the largest class, which "
                            "has {}, found {}; record more, or train with --balance",
                            of.name, few, grouped(most), of.images));
        else if (of.images < few / 2)
            doubts.push_back(
                fmt::format("{}: expected {} images or more, of which a test needs some, found {}", of.name,
                            few / 2, of.images));
        else if (times * of.images < most)
            doubts.push_back(
                fmt::format("{}: expected a third of the images of the largest class, which has {}, "
                            "found {}; train with --balance, and read the recall of each class",
                            of.name, grouped(most), grouped(of.images)));
    return doubts;
}

/// Of the images of the usual size.
std::string neighbours_of(const image_list& list, const std::vector<checked_image>& images,
                          const std::string& usual) {
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels, groups;
    std::vector<std::filesystem::path> paths;
    tactnet::shape size{};
    for (std::size_t i = 0; i < images.size(); ++i)
        if (images[i].size == usual && images[i].refused.empty()) {
            const tactnet::grey_image& image = images[i].image;
            size = {image.rows, image.columns};
            pixels.insert(pixels.end(), image.pixels.begin(), image.pixels.end());
            labels.push_back(images[i].label);
            paths.push_back(list.folder.files[i].path);
            if (!list.groups.empty())
                groups.push_back(list.groups[i]);
        }
    if (pixels.empty())
        return {};
    return neighbours_text(
        {{pixels, labels, list.folder.classes.size()}, size, groups, paths, list.folder.root});
}

int check_data(const std::filesystem::path& folder, const group_options& options,
               std::optional<double> full_scale) {
    const image_list listed = list_images(folder, options);
    const tactnet::image_folder& list = listed.folder;
    const std::vector<checked_image> images = read_images(list, folder, full_scale);
    const std::string usual = usual_size(images);
    std::vector<counts> lines;
    for (const std::string& name : list.classes)
        lines.push_back({printable(name)});
    lines.push_back({"all"});
    std::map<std::pair<std::string, std::vector<float>>, const checked_image*> first; // by pixels
    std::vector<std::string> problems, copies;
    struct refusal { // for one reason, of images of which the first is named
        const checked_image* first;
        std::size_t images = 0;
        float largest = 0;
    };
    std::map<std::string, refusal> refusals;
    std::vector<const std::string*> reasons;
    bool deep = false;
    for (const checked_image& found : images) {
        const checked_image* original = nullptr;
        if (!found.one_value)
            if (const auto& [same, is_new] = first.try_emplace({found.size, found.counts.pixels}, &found);
                !is_new)
                original = same->second;
        for (counts* line : {&lines[found.label], &lines.back()}) {
            ++line->images;
            line->copies += original != nullptr;
            line->full += found.full > 0;
            if (std::ranges::find(line->sizes, found.size) == line->sizes.end())
                line->sizes.push_back(found.size);
        }
        if (found.refused.empty())
            for (const std::string& problem : problems_of(found, usual))
                problems.push_back(found.name + ": " + problem);
        else {
            refusal& all = refusals.try_emplace(found.refused, refusal{&found}).first->second;
            if (++all.images == 1)
                reasons.push_back(&found.refused);
            for (const float count : found.counts.pixels)
                all.largest = std::max(all.largest, count);
        }
        deep = deep || found.counts.largest > 255;
        if (original != nullptr && original->label == found.label) // no problem: a sensor may repeat a frame
            copies.push_back(found.name + " is a copy of " + original->name +
                             ": a random split may train on one and test the other");
        else if (original != nullptr)
            problems.push_back(found.name + ": expected an image of one class, found a copy of " +
                               original->name);
    }
    std::size_t count = problems.size();
    for (const std::string* reason : reasons) {
        const auto& [found, same, largest] = refusals.at(*reason);
        count += same;
        problems.push_back(found->name + ": " + printable(*reason) +
                           (same > 1 ? fmt::format(", and so of {} other images", grouped(same - 1)) : "") +
                           (largest > 0 ? fmt::format("; the largest count is {}", largest) : ""));
    }
    table_cells cells{{"class", "images", "size", "copies", deep ? "at full scale" : "with 255"}};
    for (const counts& line : lines)
        cells.push_back({line.name, grouped(line.images), fmt::format("{}", fmt::join(line.sizes, ", ")),
                         grouped(line.copies), grouped(line.full)});
    std::string text = table(cells);
    for (const std::string& copy : copies)
        text += copy + '\n';
    if (const auto others = others_in(folder, list); !others.empty())
        text += fmt::format("{} files are no images of a class and are passed over, such as {}\n",
                            grouped(others.size()), name_in(folder, others.front()));
    paper_fingerprint print_of_paper(list.classes.size());
    for (const checked_image& found : images)
        print_of_paper.add(found.label, found.image.rows, found.image.columns, found.image.pixels);
    const bool of_paper = print_of_paper.of_paper();
    text += fmt::format("These are {}{}{}.\n", of_paper ? "" : "not ", paper_images,
                        of_paper ? ", to the last pixel" : "");
    for (const std::string& problem : problems)
        text += problem + '\n';
    std::vector<std::string> doubts = doubts_of(std::span(lines).first(list.classes.size()));
    for (const std::string& name : list.left_out)
        doubts.push_back(printable((list.root / name).string()) +
                         ": expected a class, found a name that begins with a dot; it is left out");
    const std::string neighbours = neighbours_of(listed, images, usual);
    for (const std::string& doubt : doubts)
        text += "warning: " + doubt + '\n';
    text += neighbours;
    const std::size_t warnings = doubts.size() + (neighbours.empty() ? 0 : 1);
    if (!problems.empty())
        text += fmt::format("{} problems\n", grouped(count));
    else if (warnings > 0)
        text += fmt::format("no image is wrong; {} warning{}\n", warnings, warnings == 1 ? "" : "s");
    else
        text += "nothing is wrong\n";
    print(text);
    return problems.empty() ? success : failed;
}

} // namespace

command add_check(CLI::App& program) {
    auto* app = program.add_subcommand(
        "check", "Describe a folder of images, report problems, and compare it with the paper's data set");
    auto folder = std::make_shared<std::string>();
    auto groups = std::make_shared<group_options>();
    add_data_option(*app, *folder);
    add_group_options(*app, *groups);
    auto images = std::make_shared<image_reading>();
    add_sensor_option(*app, images->sensor);
    return [folder, groups, images] { return check_data(*folder, *groups, images->full_scale()); };
}
