#pragma once

// Reports that compare the splits of an evaluation: intervals, a curve of accuracy against training
// images, and the prediction of every test image. As tables and in files of the folder of results.

#include "study/rows.hpp"

/// The accuracy of each method with its interval, and the difference of each to the first, on the same
/// splits: printed, and as intervals.csv.
void report_intervals(const candidate_list& candidates, const split_plan& plan,
                      const std::vector<task>& tasks, const result_list& results);

/// Accuracy against the number of training images, a line for each candidate, which uses a share of them:
/// printed, and as learning_curve.csv and .png.
void report_learning_curve(const std::vector<const candidate*>& candidates, const split_plan& plan,
                           const std::vector<task>& tasks, const result_list& results);

/// Writes the predictions of all splits of a candidate as one CSV, each line after its split and seed.
/// Returns how many trainings have none, since another program made them.
std::size_t write_predictions(const std::filesystem::path& file, const candidate& of, std::size_t bits,
                              const std::vector<task>& tasks);
