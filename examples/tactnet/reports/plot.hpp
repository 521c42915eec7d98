#pragma once

// Pictures, drawn by gnuplot if it is installed. Data go into a CSV file that stays; where there is no
// gnuplot the script stays beside it, and a message says how to draw it later.

#include <tactnet/training/data/split.hpp>
#include <tactnet/training/loop/progress.hpp>
#include <tactnet/training/metrics.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// Writes STEM.csv and STEM.png.
void plot_learning_curve(const std::filesystem::path& stem, const std::string& title,
                         std::span<const tactnet::epoch_report> history);
void plot_confusion(const std::filesystem::path& stem, const std::string& title,
                    const tactnet::confusion_matrix& confusion, const std::vector<std::string>& classes);

/// Over all splits by one rule.
struct split_accuracy {
    tactnet::split_rule rule;
    tactnet::mean_and_deviation accuracy;
};

/// A method in the picture of what accuracy costs.
struct cost_point {
    std::string name;
    double multiply_adds, microseconds;
    std::vector<split_accuracy> accuracies;
};
/// All points have the same rules in the same order.
void plot_costs(const std::filesystem::path& stem, std::span<const cost_point> points);
