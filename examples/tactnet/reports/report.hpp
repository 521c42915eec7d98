#pragma once

// Results as text: tables for people, CSV and JSON lines for programs.

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// In double quotes where CSV needs them (RFC 4180), behind an apostrophe where a spreadsheet would take it
/// for a formula.
std::string csv_field(std::string_view text);

/// A line for each object, all of which have the same members in the same order; null is an empty field.
std::string csv_of(std::span<const nlohmann::ordered_json> rows);

/// Writes the same as STEM.csv, and as JSON lines to STEM.jsonl.
void write_lines(const std::filesystem::path& stem, std::span<const nlohmann::ordered_json> rows);

/// "1 717 696".
std::string grouped(std::size_t number);

/// Rows of cells, the head first.
using table_cells = std::vector<std::vector<std::string>>;

/// Without the columns that have no text below their head.
table_cells without_empty_columns(const table_cells& rows);

/// For a terminal, in columns as wide as need be. The first column is left-aligned.
std::string table(const table_cells& rows);
std::string markdown_table(const table_cells& rows);

/// The texts of the scripts of this program, by names such as "confusion"; the build has put them into it.
extern const std::map<std::string, std::string> gnuplot_scripts;
