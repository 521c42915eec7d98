#pragma once

// The rows of an evaluation or a study: a method at a size with a recipe, what it recognised, and what it
// costs.

#include "evaluation/trainings.hpp"
#include "study/published.hpp"
#include "study/timings.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

enum class method_family { touches, photographs, machines };

struct split_accuracies {
    tactnet::split_rule rule;
    std::size_t splits, wanted; ///< that were trained and tested, of how many
    tactnet::mean_and_deviation test;
    double validation, training; ///< means; NaN where nothing is known
    /// On test images, averaged over their reflections, of as many splits.
    tactnet::mean_and_deviation reflected{};
    std::size_t reflected_splits = 0;
};

struct study_row {
    std::string method;
    std::size_t rows, columns;
    std::string recipe;
    std::size_t bits = 32; ///< of a weight
    method_family family = method_family::touches;
    std::string missing{}; ///< why it was not run; else empty
    method_costs costs{};
    std::vector<split_accuracies> accuracies{}; ///< by the rules that were run
    double seconds = 0; ///< of the quickest training, since others may have shared the machine
    std::optional<frame_latency> latency{};
    /// The same in the paper, where it has it.
    const published_result* published = nullptr;
    std::string declaration{}; ///< its type in C++, of a network that is one
    std::vector<std::string> classes{};
    tactnet::confusion_matrix confusion{}; ///< of all random splits, or of the others where there are none
    /// Calibration over these splits at the mean temperature; empty for methods without probabilities.
    std::optional<calibration> probabilities{};
    decision_means decisions{}; ///< means over these splits
};

/// The accuracy by a rule, or nothing.
const split_accuracies* find_accuracy(const study_row& row, tactnet::split_rule rule);

/// "tactnet6", or "tactnet6 in 8 bits".
std::string method_title(const study_row& row);
/// "tactnet6 in 8 bits 28x50", and the recipe where it is not the default.
std::string title_of(const study_row& row);

/// The time of a method with weights of so many bits, if there is one.
using time_of_method = std::function<std::optional<frame_latency>(const method& what, std::size_t bits)>;

/// A row for each candidate, and one more if it is tried in 8 bits. Throws tactnet::file_error for results of
/// other classes.
std::vector<study_row> rows_of(const candidate_list& candidates, const split_plan& plan,
                               const std::vector<task>& tasks, const result_list& results,
                               const time_of_method& time);

/// What pictures show: random splits if there are any, else blocked ones.
tactnet::split_rule shown_rule(const std::vector<study_row>& rows);

/// Of rows with all their splits those with which no other is both faster and more accurate on splits by the
/// rule, the fastest first.
std::vector<const study_row*> pareto_front(const std::vector<study_row>& rows, tactnet::split_rule rule);

/// The row that is most accurate on splits by the rule, or nothing.
const study_row* most_accurate(const std::vector<study_row>& rows, tactnet::split_rule rule);

/// With a checksum each, and its place among all lines.
std::string study_json_lines(const std::vector<study_row>& rows);
std::string study_csv(const std::vector<study_row>& rows);
