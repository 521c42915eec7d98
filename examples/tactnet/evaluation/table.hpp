#pragma once

// What an evaluation found, as a table for people, as CSV and as JSON lines.

#include "evaluation/frame_times.hpp"
#include "methods/method.hpp"
#include "reports/plot.hpp"

#include <cstddef>
#include <string>
#include <vector>

/// All splits of a method.
struct evaluation_row {
    const method* what;
    std::string recipe;
    method_costs costs;
    frame_times times;
    std::vector<split_accuracy> accuracies; ///< by the rules that were asked for
    tactnet::mean_and_deviation seconds;
    tactnet::confusion_matrix confusion;
    std::size_t splits = 0;
    std::size_t bits = 32; ///< of a weight
};

/// Tells bits where some row has 8.
std::string table_of(const std::vector<evaluation_row>& rows);
std::string json_lines_of(const std::vector<evaluation_row>& rows);
/// The same numbers as the JSON lines, in their order.
std::string csv_of(const std::vector<evaluation_row>& rows);
