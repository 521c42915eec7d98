#pragma once

// Results as text: tables for people, CSV and JSON lines for programs.

#include <tactnet/training/loop/progress.hpp>
#include <tactnet/training/metrics.hpp>

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Throws usage_error unless a file could be written there: so that hours of work do not end without a place
/// for their result.
void check_writable(const std::filesystem::path& path);

/// Makes the folder of a file, if there is none.
void make_folder_of(const std::filesystem::path& path);

/// In double quotes where CSV needs them (RFC 4180).
std::string csv_field(std::string_view text);

/// A line for each object, all of which have the same members in the same order; null is an empty field.
std::string csv_of(std::span<const nlohmann::ordered_json> rows);

/// "1 717 696".
std::string grouped(std::size_t number);

/// Rows of cells in columns as wide as need be; the first row is the head. The first column is left-aligned.
std::string table(const std::vector<std::vector<std::string>>& rows);

/// One line an epoch.
std::string learning_curve_csv(std::span<const tactnet::epoch_report> history);
std::string learning_curve_json_lines(std::span<const tactnet::epoch_report> history);

/// One row a true class, one column a recognised one.
std::string confusion_csv(const tactnet::confusion_matrix& confusion,
                          const std::vector<std::string>& classes);
