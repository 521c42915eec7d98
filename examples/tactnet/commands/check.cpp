// tactnet check: a folder of images as the program reads it, and what is wrong with it.

#include "commands/commands.hpp"
#include "console.hpp"
#include "data/folder_check.hpp"
#include "methods/training_settings.hpp"
#include "reports/report.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace {

std::string size_text(std::size_t rows, std::size_t columns) {
    return fmt::format("{}x{}", rows, columns);
}

/// What of a class, or of all, goes into a line of the table.
struct summary {
    std::size_t images = 0, copies = 0, full = 0;
    std::vector<std::string> sizes{};

    void add(const checked_image& image) {
        ++images;
        full += image.full > 0;
        if (const std::string size = image.readable() ? size_text(image.rows, image.columns) : "unreadable";
            std::ranges::find(sizes, size) == sizes.end())
            sizes.push_back(size);
    }
    std::vector<std::string> line(const std::string& name) const {
        return {name, grouped(images), fmt::format("{}", fmt::join(sizes, ", ")), grouped(copies),
                grouped(full)};
    }
};

std::string table_of(const folder_check& check) {
    std::vector<summary> classes(check.classes.size());
    summary all;
    for (const checked_image& image : check.images) {
        classes[image.label].add(image);
        all.add(image);
    }
    for (const auto& copy : check.copies)
        ++classes[check.images[copy.second].label].copies;
    all.copies = check.copies.size();
    std::vector<std::vector<std::string>> cells{{"class", "images", "size", "copies", "with 255"}};
    for (std::size_t c = 0; c < classes.size(); ++c)
        cells.push_back(classes[c].line(printable(check.classes[c])));
    cells.push_back(all.line("all"));
    return table(cells);
}

/// Each in a line.
std::vector<std::string> problems_of(const folder_check& check, const std::filesystem::path& folder) {
    std::vector<std::string> problems;
    const auto name_of = [&](const checked_image& image) {
        return printable(image.path.lexically_relative(folder).string());
    };
    const std::string usual = size_text(check.rows, check.columns);
    for (const checked_image& image : check.images) {
        if (!image.readable()) {
            problems.push_back(fmt::format("{}: {}", name_of(image), printable(image.unreadable)));
            continue;
        }
        if (image.rows != check.rows || image.columns != check.columns)
            problems.push_back(
                fmt::format("{}: expected {} as most images, or --resize in training, found {}",
                            name_of(image), usual, size_text(image.rows, image.columns)));
        if (image.empty())
            problems.push_back(
                fmt::format("{}: expected a touch, found the same value in all tactels", name_of(image)));
        if (image.saturated())
            problems.push_back(fmt::format("{}: expected pressures that the sensor can tell, found {} of {} "
                                           "pressed tactels at 255",
                                           name_of(image), image.full, image.pressed));
    }
    for (const auto& copy : check.copies)
        if (!check.within_a_class(copy))
            problems.push_back(fmt::format("{}: expected an image of one class, found a copy of {}",
                                           name_of(check.images[copy.second]),
                                           name_of(check.images[copy.first])));
    return problems;
}

/// Told, but nothing wrong: a sensor may send a frame twice.
std::string notes_of(const folder_check& check, const std::filesystem::path& folder) {
    std::string text;
    const auto name_of = [&](std::size_t index) {
        return printable(check.images[index].path.lexically_relative(folder).string());
    };
    for (const auto& copy : check.copies)
        if (check.within_a_class(copy))
            text += fmt::format("{} is a copy of {}: a random split may train on one and test the other\n",
                                name_of(copy.second), name_of(copy.first));
    if (!check.passed_over.empty())
        text += fmt::format("{} files are no images of a class and are passed over, such as {}\n",
                            grouped(check.passed_over.size()),
                            printable(check.passed_over.front().lexically_relative(folder).string()));
    return text;
}

/// Whether they are the images of the paper.
std::string origin_of(const folder_check& check) {
    using paper = paper_images;
    const std::string what = fmt::format(
        "the paper's {} images of {} classes, {}x{}, of which {} are copies ({})", grouped(paper::images),
        paper::classes, paper::rows, paper::columns, paper::copies, paper::source);
    return check.fingerprint() == paper::fingerprint ? "These are " + what + ", to the last pixel.\n"
                                                     : "These are not " + what + ".\n";
}

int check_data(const std::filesystem::path& folder) {
    const folder_check check = check_folder(folder);
    const std::vector<std::string> problems = problems_of(check, folder);
    std::string text = table_of(check) + notes_of(check, folder) + origin_of(check);
    for (const std::string& problem : problems)
        text += problem + '\n';
    text += problems.empty() ? "nothing is wrong\n" : fmt::format("{} problems\n", grouped(problems.size()));
    print(text);
    return problems.empty() ? success : failed;
}

} // namespace

command add_check(CLI::App& program) {
    auto* app = program.add_subcommand(
        "check", "Describe a folder of images, report problems, and compare it with the paper's data set");
    auto folder = std::make_shared<std::string>();
    add_data_option(*app, *folder);
    return [folder] { return check_data(*folder); };
}
