#pragma once

// The rows of an evaluation or a study: a method at a size with a recipe, what it recognised, and what it
// costs.

#include "evaluation/trainings.hpp"
#include "study/timings.hpp"

#include <nlohmann/json.hpp>

#include <functional>

struct study_row {
    /// What programs get: a line of JSON or of a CSV file, the same members in each row, null for what is not
    /// known. Tables and pictures show the same.
    nlohmann::ordered_json values;
    std::string family; ///< in pictures: "touches", "photographs" or "machines"
    std::vector<std::string> classes{};
    tactnet::confusion_matrix confusion{}; ///< of all splits by the first rule that there are results of
    /// Calibration over these splits at the mean temperature; empty for methods without probabilities.
    std::optional<calibration> probabilities{};
};

/// A row of which nothing else is known.
study_row make_row(const std::string& method, std::size_t rows, std::size_t columns,
                   const std::string& recipe, std::size_t bits);

/// A member that is text.
std::string text(const study_row& row, std::string_view name);
/// A member that is a number; NaN for null.
double number(const study_row& row, std::string_view name);
/// A member of one rule, such as "random_accuracy" by the name "accuracy".
double number(const study_row& row, tactnet::split_rule rule, std::string_view name);

/// "tactnet6", or "tactnet6 in 8 bits".
std::string method_title(const study_row& row);
/// "tactnet6 in 8 bits 28x50", and the recipe where it is not the default.
std::string title_of(const study_row& row);

/// The time of a method with weights of so many bits, if there is one.
using time_of_method = std::function<std::optional<frame_latency>(const method& what, std::size_t bits)>;

/// A row for each candidate and number of bits. Throws usage_error for results of other classes.
std::vector<study_row> rows_of(const candidate_list& candidates, const split_plan& plan,
                               const std::vector<task>& tasks, const result_list& results,
                               const time_of_method& time);

/// Puts a calibration into its members.
void put_calibration(study_row& row, const calibration& of);

/// What pictures show: the first rule of `split_rule_names` that there are results of.
tactnet::split_rule shown_rule(const std::vector<study_row>& rows);

/// Rows with all their splits than which no other is both faster and more accurate, the fastest first.
std::vector<study_row> pareto_front(const std::vector<study_row>& rows, tactnet::split_rule rule);

/// The row that is most accurate on splits by the rule, or nothing.
const study_row* most_accurate(const std::vector<study_row>& rows, tactnet::split_rule rule);

/// FOLDER/NAME.jsonl, with a checksum in each line and its place among all, and the same as FOLDER/NAME.csv.
void write_rows(const std::vector<study_row>& rows, const std::filesystem::path& folder,
                const std::string& name);
