#pragma once

// What an evaluation or a study compares: methods with their images, and the splits that all are tried on.

#include "data/image_data.hpp"
#include "evaluation/results.hpp"
#include "evaluation/trainings.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

struct split_plan {
    std::vector<tactnet::split_rule> rules;
    std::uint64_t first_seed = 0;
    std::size_t splits = 10; ///< by each rule; their seeds follow the first
};

/// Throws usage_error for seeds beyond 64 bits.
void check_seeds(const split_plan& plan);

/// Candidates with all that their trainings need.
class candidate_list {
public:
    /// `chosen` says what and how; images, the network to start from and pretrained weights are loaded here.
    /// Throws usage_error and tactnet::file_error for all that can be wrong.
    candidate_list(const std::filesystem::path& data, std::vector<candidate> chosen);
    candidate_list(const candidate_list&) = delete;
    candidate_list& operator=(const candidate_list&) = delete;

    auto begin() const { return list_.begin(); }
    auto end() const { return list_.end(); }

private:
    std::map<std::pair<std::size_t, std::size_t>, image_data> data_;
    std::vector<candidate> list_;
};

/// All trainings of the plan, split by split, so that early results say something of every candidate.
std::vector<task> tasks_of(const candidate_list& candidates, const split_plan& plan);

/// Does the trainings, `jobs` at a time, and first finds what pretrained networks make of the images for
/// those that need it; this is kept beside the results. False if interrupted. Trainings that diverge are
/// added to `diverged` and left out; without such a list the first one ends all.
bool train_all(const std::vector<task>& to_do, std::size_t jobs, result_list& results,
               std::vector<std::string>* diverged = nullptr);
