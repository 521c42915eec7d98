#pragma once

// What an experimenter reports of a test: each class, and each image.

#include "data/image_data.hpp"
#include "reports/report.hpp"

#include <tactnet/training/evaluate.hpp>

#include <nlohmann/json.hpp>

/// A line for each class, and one for their means: images, right ones, recall, precision and F1.
table_cells class_table(const tactnet::confusion_matrix& confusion, const std::vector<std::string>& classes);

/// Writes the same as STEM.csv, and as JSON lines to STEM.jsonl.
void write_class_report(const std::filesystem::path& stem, const tactnet::confusion_matrix& confusion,
                        const std::vector<std::string>& classes);

/// Returns a line for each tested image, as CSV: the members of `first`, path, group, label, prediction, and
/// for a network the probability of each class at that temperature. The heading is one line.
std::string predictions_csv(const image_data& data, std::span<const std::size_t> images,
                            const tactnet::evaluation& result, double temperature,
                            const nlohmann::ordered_json& first = nlohmann::ordered_json::object());
