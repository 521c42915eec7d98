#pragma once

// What an evaluation or a study compares, methods with their images, and its trainings, many at once.

#include "data/grouping.hpp"
#include "evaluation/results.hpp"
#include "methods/training_settings.hpp"

#include <algorithm>
#include <thread>

/// A method with the images of its size.
struct candidate {
    const method* what;
    training_settings training;
    std::shared_ptr<const image_data> data{};
    std::shared_ptr<const trained_method> start{};
    std::shared_ptr<pretrained_weights> pretrained{};
    std::filesystem::path predictions{}; ///< a folder for those of each training, unless empty
};

/// The bits of a weight that a candidate is reported in: 32, and 8 if its trainings are.
inline std::vector<std::size_t> bits_of(const candidate& c) {
    return c.training.bits == 8 ? std::vector<std::size_t>{32, 8} : std::vector<std::size_t>{32};
}

/// One training to do.
struct task {
    const candidate* of;
    tactnet::split_rule rule;
    std::uint64_t seed;
    tactnet::file_metadata settings;
};

/// Where the predictions of a training are, by its settings.
std::filesystem::path predictions_of(const candidate& c, const tactnet::file_metadata& settings);

/// Where an interrupted training keeps what its short trainings have scored.
std::filesystem::path trials_of(const task& t, const result_list& results);

struct split_plan {
    std::vector<tactnet::split_rule> rules;
    std::uint64_t first_seed = 0;
    std::size_t splits = 10; ///< by each rule; their seeds follow the first
};

/// What evaluations and studies have in common.
struct evaluation_options {
    std::string data, results = "results", split;
    group_options groups;
    std::size_t usual_splits = 10; ///< of rules without folds
    std::optional<std::size_t> splits{};
    std::size_t jobs = std::max(1U, std::thread::hardware_concurrency());
    bool elsewhere = false; ///< trainings by other programs take the place of those that are missing
};
/// --data, those of groups, --results, --split, --splits, --jobs and --elsewhere.
void add_evaluation_options(CLI::App& app, evaluation_options& options);

using candidate_list = std::vector<candidate>;
/// Loads images and weights to begin with, and returns the splits. Throws usage_error and tactnet::file_error
/// for all that can be wrong, in each of the splits too.
split_plan load_candidates(candidate_list& list, const evaluation_options& options,
                           std::uint64_t first_seed = 0);

/// All trainings of the plan, split by split, so that early results say something of every candidate.
std::vector<task> tasks_of(const candidate_list& candidates, const split_plan& plan);

/// Trainings of other versions and instruction sets take the place of those that this program has not made;
/// of one in 8 bits that in single precision alone only if `in_part`. Returns which, in words, and warns of
/// them.
std::string take_from_elsewhere(std::vector<task>& tasks, const result_list& results, bool in_part);
/// Says how many results in the folder are of no task, and why.
void tell_others(const std::vector<task>& tasks, const result_list& results);

/// Does the trainings that have no results yet, `jobs` at a time, shared with other programs on that file.
/// First keeps features of frozen networks in its folder. False if interrupted. Trainings that diverge are
/// left out and added to `diverged`; without such a list the first one ends all.
bool train_all(const std::vector<task>& all, std::size_t jobs, result_list& results,
               std::vector<std::string>* diverged = nullptr);
