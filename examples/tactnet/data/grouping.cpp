#include "data/grouping.hpp"

#include "console.hpp"
#include "data/input_file.hpp"
#include "number_options.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/model_description.hpp>
#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/text/message.hpp>

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <regex>
#include <string_view>

namespace {

/// A row of a table in CSV: the line that it begins in, and its cells.
struct csv_row {
    std::size_t line;
    std::vector<std::string> cells;
};

/// RFC 4180, of any line ends, without empty rows.
std::vector<csv_row> rows_of_csv(std::string_view text, const std::string& file) {
    if (text.starts_with("\xEF\xBB\xBF")) // a byte order mark of editors on Windows
        text.remove_prefix(3);
    std::vector<csv_row> rows;
    std::size_t line = 1;
    bool quoted = false, closed = false, new_row = true;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (new_row)
            rows.push_back({line, {""}});
        new_row = false;
        std::string& cell = rows.back().cells.back();
        line += c == '\n';
        if (quoted) {
            if (c != '"')
                cell += c;
            else if (i + 1 < text.size() && text[i + 1] == '"')
                cell += text[++i];
            else
                quoted = false, closed = true;
        } else if (c == '"' && cell.empty() && !closed) {
            quoted = true;
        } else if (c == ',' || c == '\n') {
            closed = false;
            if (c == ',')
                rows.back().cells.emplace_back();
            else
                new_row = true;
        } else if (c != '\r') {
            if (closed || c == '"')
                throw tactnet::file_error(file, fmt::format("line {}", line),
                                          "quotation marks around whole cells", "others");
            cell += c;
        }
    }
    if (quoted)
        throw tactnet::file_error(file, fmt::format("line {}", rows.back().line),
                                  "a quotation mark at the end of a cell", "the end of the file");
    std::erase_if(rows, [](const csv_row& row) { return row.cells == std::vector<std::string>{""}; });
    return rows;
}

/// Numbers names by their natural order.
std::vector<std::size_t> numbered(const std::vector<std::string>& names,
                                  std::vector<std::string>& different) {
    different = names;
    std::ranges::sort(different, tactnet::natural_less);
    different.erase(std::unique(different.begin(), different.end()), different.end());
    std::vector<std::size_t> numbers;
    for (const std::string& name : names)
        numbers.push_back(static_cast<std::size_t>(
            std::ranges::lower_bound(different, name, tactnet::natural_less) - different.begin()));
    return numbers;
}

constexpr std::array<std::string_view, 4> table_columns{"path", "label", "group", "split"};

/// Cells by line, in the order of `table_columns`; nothing for those that the table has not.
struct table_row {
    std::size_t line;
    std::array<std::optional<std::string>, 4> cells;
};

std::vector<table_row> read_table(const std::string& file) {
    check_no_device(file);
    const auto bytes = tactnet::read_file(file, std::size_t{1} << 28);
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (!tactnet::is_utf8(text) || text.find('\0') != std::string::npos) // which ends the name of a file
        throw tactnet::file_error(file, "", "a table in UTF-8", "other bytes");
    const std::vector<csv_row> rows = rows_of_csv(text, file);
    std::vector<std::string> head = rows.empty() ? std::vector<std::string>{} : rows[0].cells;
    for (std::string& name : head) // " Split" is meant as split
        name = tactnet::detail::lower_case(std::string(tactnet::trimmed(name)));
    const auto place_of = [&](std::string_view name) {
        return static_cast<std::size_t>(std::ranges::find(head, name) - head.begin());
    };
    if (rows.size() < 2 || place_of("path") == head.size())
        throw tactnet::file_error(file, "line 1",
                                  "columns path, label, group, split, of which path is needed, "
                                  "and a line for each image",
                                  rows.empty() ? "an empty table"
                                  : place_of("path") == head.size()
                                      ? tactnet::in_quotes(fmt::format("{}", fmt::join(head, ",")))
                                      : "no image");
    for (std::size_t c = 0; c < head.size(); ++c)
        if (std::ranges::find(table_columns, head[c]) == table_columns.end())
            throw tactnet::file_error(file, fmt::format("line 1, column {}", c + 1),
                                      "path, label, group or split", tactnet::in_quotes(head[c]));
    std::array<std::size_t, table_columns.size()> places{};
    for (std::size_t c = 0; c < places.size(); ++c) {
        places[c] = place_of(table_columns[c]);
        if (std::ranges::count(head, table_columns[c]) > 1)
            throw tactnet::file_error(file, "line 1", fmt::format("one column {}", table_columns[c]),
                                      "several");
    }
    std::vector<table_row> found;
    std::map<std::string, std::size_t> lines; // of paths
    for (std::size_t r = 1; r < rows.size(); ++r) {
        const std::string place = fmt::format("line {}", rows[r].line);
        if (rows[r].cells.size() != head.size())
            throw tactnet::file_error(file, place, fmt::format("{} cells", head.size()),
                                      fmt::to_string(rows[r].cells.size()));
        table_row& row = found.emplace_back(table_row{rows[r].line, {}});
        for (std::size_t c = 0; c < table_columns.size(); ++c)
            if (places[c] < head.size()) {
                row.cells[c] = rows[r].cells[places[c]];
                if (row.cells[c]->empty())
                    throw tactnet::file_error(file, place, fmt::format("a {}", table_columns[c]),
                                              "an empty cell");
            }
        const std::string path = std::filesystem::path(*row.cells[0]).lexically_normal().string();
        if (const auto [first, is_new] = lines.try_emplace(path, row.line); !is_new)
            throw tactnet::file_error(file, place, "each image once",
                                      fmt::format("{}, which is in line {} already",
                                                  tactnet::in_quotes(*row.cells[0]), first->second));
    }
    return found;
}

image_list images_of_table(const std::filesystem::path& folder, const std::string& file) {
    std::vector<table_row> rows = read_table(file);
    image_list list;
    list.folder.root = folder;
    for (table_row& row : rows)
        if (!row.cells[1]) { // the class is the folder
            const std::filesystem::path path = *row.cells[0];
            if (path.is_absolute() || path.begin() == --path.end())
                throw tactnet::file_error(
                    file, fmt::format("line {}", row.line),
                    "a path that begins with the folder of the class, or a column label",
                    tactnet::in_quotes(path.string()));
            row.cells[1] = path.begin()->string();
        }
    std::map<std::string, std::size_t> labels;
    for (const table_row& row : rows)
        labels.emplace(*row.cells[1], 0);
    for (auto& [name, label] : labels) {
        label = list.folder.classes.size();
        list.folder.classes.push_back(name);
    }
    if (const std::string problem = tactnet::detail::problem_of_names(list.folder.classes); !problem.empty())
        throw tactnet::file_error(file, "column 'label'", std::string(tactnet::detail::expected_names),
                                  problem);
    if (labels.size() < 2)
        throw tactnet::file_error(file, "column 'label'", "at least two classes",
                                  "only " + tactnet::in_quotes(labels.begin()->first));
    // By class, as a folder is read; within a class in the order of the table, which is that of recording.
    std::ranges::stable_sort(rows, {},
                             [](const table_row& row) -> const std::string& { return *row.cells[1]; });
    std::vector<std::string> groups;
    tactnet::data_split given;
    for (const table_row& row : rows) {
        const std::size_t image = list.folder.files.size();
        list.folder.files.push_back({folder / *row.cells[0], labels.at(*row.cells[1])});
        if (row.cells[2])
            groups.push_back(*row.cells[2]);
        if (!row.cells[3])
            continue;
        const std::string& part = *row.cells[3];
        auto* const to = part == "training" || part == "train"                      ? &given.training
                         : part == "validation" || part == "valid" || part == "val" ? &given.validation
                         : part == "test"                                           ? &given.test
                                                                                    : nullptr;
        if (to == nullptr)
            throw tactnet::file_error(file, fmt::format("line {}, column 'split'", row.line),
                                      "training, validation or test", tactnet::in_quotes(part));
        to->push_back(image);
    }
    if (rows.front().cells[3])
        list.given = std::move(given);
    list.groups = numbered(groups, list.group_names);
    return list;
}

/// What the pattern finds in the path below the folder of the class: its first part in brackets, or all.
std::vector<std::string> groups_by_pattern(const tactnet::image_folder& folder, const std::string& pattern) {
    std::vector<std::string> groups;
    try {
        const std::regex expression(pattern);
        for (const auto& [path, label] : folder.files) {
            const std::string name = path.filename().string();
            std::smatch found;
            if (!std::regex_search(name, found, expression))
                refuse("--group: expected names that match '{}', found {}", pattern,
                       tactnet::in_quotes(path.string()));
            groups.push_back(found.size() > 1 ? found.str(1) : found.str());
        }
    } catch (const std::regex_error&) {
        refuse("--group: expected a regular expression (ECMAScript) such as 'subject(\\d+)', found {}",
               tactnet::in_quotes(pattern));
    }
    return groups;
}

} // namespace

void add_group_options(CLI::App& command, group_options& o) {
    auto* pattern = command.add_option(
        "--group", o.pattern,
        "Images that belong together, such as those of a person, an object or a session: a regular "
        "expression "
        "of the file name, of which the part in brackets is the group, such as 'subject(\\d+)'");
    auto* folders = command.add_flag("--group-folders", o.folders,
                                     "Images are in a folder for each group, below that of the class");
    auto* table = command.add_option(
        "--table", o.table,
        "Table of the images, CSV: path (below --data), and as far as known label, group and split "
        "(training, validation or test, which fixes the split)");
    table->type_name("FILE")->excludes(pattern)->excludes(folders);
    folders->excludes(pattern);
}

image_list list_images(const std::filesystem::path& folder, const group_options& o) {
    if (!o.table.empty())
        return images_of_table(folder, o.table);
    image_list list{tactnet::list_image_folder(folder, image_extensions,
                                               o.folders ? tactnet::image_folder_layout::groups_in_classes
                                                         : tactnet::image_folder_layout::classes)};
    std::vector<std::string> groups;
    if (!o.pattern.empty())
        groups = groups_by_pattern(list.folder, o.pattern);
    else if (o.folders)
        for (const auto& [path, label] : list.folder.files)
            groups.push_back(path.parent_path().filename().string());
    list.groups = numbered(groups, list.group_names);
    return list;
}

std::vector<name_pattern> patterns_of_names(std::span<const std::filesystem::path> paths) {
    std::map<std::string, std::vector<std::string>> found; // by what comes before the digits
    for (const auto& path : paths) {
        const std::string name = path.stem().string();
        std::string before;
        for (std::size_t i = 0; i < name.size();) {
            const auto is_digit = [&](std::size_t at) { return name[at] >= '0' && name[at] <= '9'; };
            const std::size_t start = i;
            while (i < name.size() && is_digit(i) == is_digit(start))
                ++i;
            if (is_digit(start))
                found[before].push_back(name.substr(start, i - start));
            else
                before = name.substr(start, i - start);
        }
    }
    std::vector<name_pattern> patterns;
    for (const auto& [before, numbers] : found) {
        std::vector<std::string> different;
        name_pattern next{before + "(\\d+)", {}};
        if (numbers.size() != paths.size() || before.empty() || !std::ranges::all_of(before, [](char c) {
                return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-';
            }))
            continue; // not once in every name, or not to be written as it is
        next.groups = numbered(numbers, different);
        if (different.size() > 1 && 2 * different.size() <= paths.size())
            patterns.push_back(std::move(next));
    }
    return patterns;
}
