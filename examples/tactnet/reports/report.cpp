#include "reports/report.hpp"

#include <tactnet/io/write_file.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>

std::string csv_field(std::string_view text) {
    // A spreadsheet runs what begins with one of these; the apostrophe makes it text.
    const bool runs = !text.empty() && std::string_view("=+-@\t\r").find(text[0]) != std::string_view::npos;
    if (text.find_first_of(",;\"\r\n") == std::string_view::npos)
        return (runs ? "'" : "") + std::string(text);
    std::string quoted = runs ? "\"'" : "\"";
    for (const char c : text)
        quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

std::string csv_of(std::span<const nlohmann::ordered_json> rows) {
    std::string text;
    for (const nlohmann::ordered_json& row : rows) {
        std::vector<std::string> head, line;
        for (const auto& [key, value] : row.items()) {
            const std::string plain = value.is_string() ? csv_field(value.get<std::string>()) : value.dump();
            head.push_back(csv_field(key));
            line.push_back(value.is_string() || plain != "null" ? plain
                                                                : ""); // also of numbers that are none
        }
        if (text.empty())
            text = fmt::format("{}\n", fmt::join(head, ","));
        text += fmt::format("{}\n", fmt::join(line, ","));
    }
    return text;
}

void write_lines(const std::filesystem::path& stem, std::span<const nlohmann::ordered_json> rows) {
    std::string lines;
    for (const nlohmann::ordered_json& row : rows)
        lines += row.dump() + '\n';
    tactnet::write_file(std::filesystem::path(stem) += ".csv", csv_of(rows));
    tactnet::write_file(std::filesystem::path(stem) += ".jsonl", lines);
}

std::string grouped(std::size_t number) {
    std::string text = fmt::to_string(number);
    for (std::size_t place = text.size(); place > 3; place -= 3)
        text.insert(place - 3, " ");
    return text;
}

table_cells without_empty_columns(const table_cells& rows) {
    table_cells kept(rows.size());
    for (std::size_t c = 0; c < rows.at(0).size(); ++c)
        if (std::any_of(rows.begin() + 1, rows.end(), [&](const auto& row) { return !row[c].empty(); }))
            for (std::size_t r = 0; r < rows.size(); ++r)
                kept[r].push_back(rows[r][c]);
    return kept;
}

std::string table(const table_cells& rows) {
    const auto width_of = [](std::string_view text) { // characters, of UTF-8
        return static_cast<std::size_t>(
            std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
    };
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t i = 0; i < row.size(); ++i)
            widths[i] = std::max(widths[i], width_of(row[i]));
    }
    std::string text;
    for (const auto& row : rows) {
        std::string line, rule;
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::string space(widths[i] - width_of(row[i]), ' ');
            line += (i > 0 ? "  " : "") + (i == 0 ? row[i] + space : space + row[i]);
            rule += (i > 0 ? "  " : "") + std::string(widths[i], '-');
        }
        text += line + '\n' + (&row == &rows.front() ? rule + '\n' : "");
    }
    return text;
}

std::string markdown_table(const table_cells& rows) {
    const auto line_of = [](const std::vector<std::string>& cells) {
        std::string line = "|";
        for (const std::string& cell : cells) {
            line += ' ';
            for (const char c : cell)
                line += c == '|' || c == '\\' ? std::string{'\\', c} : std::string{c};
            line += cell.empty() ? "|" : " |";
        }
        return line + '\n';
    };
    std::string text;
    for (const auto& row : rows) {
        text += line_of(row);
        if (&row == &rows.front())
            text += line_of(std::vector<std::string>(row.size(), "---"));
    }
    return text;
}
