#pragma once

// Pictures, drawn by gnuplot if it is installed: each from a CSV file, by a script that the program holds.

#include "evaluation/results.hpp"

#include <tactnet/training/loop/progress.hpp>

/// Writes STEM.csv, and draws it as STEM.png by a script, which gets file, title and names of series as
/// arguments: no gnuplot and no shell reads these as commands. Returns false where it cannot be drawn, after
/// a message that says why.
bool draw_picture(const std::string& script, const std::filesystem::path& stem, const std::string& csv,
                  const std::string& title, const std::vector<std::string>& names = {});

/// A line for each epoch of a training.
void plot_learning_curves(const std::filesystem::path& stem, const std::string& title,
                          std::span<const tactnet::epoch_report> history);

/// A row for each true class, a column for each recognised one.
void plot_confusion(const std::filesystem::path& stem, const std::string& title,
                    const tactnet::confusion_matrix& confusion, const std::vector<std::string>& classes);

/// A line for each bin of probabilities, by the softmax and by the fitted temperature.
void plot_reliability(const std::filesystem::path& stem, const std::string& title, const calibration& of);
