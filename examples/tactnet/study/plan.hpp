#pragma once

// What a study tries.

#include "evaluation/trainings.hpp"
#include "study/rows.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

struct study_options {
    std::string data, results = "study", shard;
    std::vector<std::string> methods, sizes, recipes{"default", "published"}, pretrained, merged, peers;
    std::string code_bytes, split = "both";
    std::size_t splits = 20, jobs = std::max(1U, std::thread::hardware_concurrency());
    std::size_t bits = 8;    ///< 8: networks in 8 bits too, where they have such a form
    std::size_t unknown = 0; ///< see training_settings
    bool report_only = false, only_trained = false, times_only = false;
};

/// "squeezenet=FILE" by its name. Throws usage_error.
std::map<std::string, std::string, std::less<>> pretrained_files(const study_options& o);

/// What is tried, and what cannot be.
struct study_plan {
    candidate_list candidates;
    std::vector<study_row> missing;   ///< for want of a pretrained network
    std::vector<study_row> not_built; ///< of the paper
};

/// Every method of the program at every size, and those of the paper that it lacks. Throws usage_error.
study_plan plan_of(const study_options& o);
