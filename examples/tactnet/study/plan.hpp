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
    std::string code_bytes, trained_by;
    std::string split = "both";
    std::size_t splits = 20, jobs = std::max(1U, std::thread::hardware_concurrency());
    std::size_t bits = 8; ///< 8: networks in 8 bits too, where they have such a form
    bool report_only = false, only_trained = false, times_only = false;
};

/// "squeezenet=FILE" by the name in front. Throws usage_error.
std::map<std::string, std::string, std::less<>> pretrained_files(const study_options& o);

/// What is tried, and what cannot be.
struct study_plan {
    std::vector<candidate> candidates;
    std::vector<study_row> missing;
};

/// Every method of the program at every size, and of the paper those that it lacks. Throws usage_error.
study_plan plan_of(const study_options& o);

/// What a candidate is told in: single precision, and 8 bits if its trainings are.
inline std::vector<std::size_t> bits_of(const candidate& c) {
    return c.training.bits == 8 ? std::vector<std::size_t>{32, 8} : std::vector<std::size_t>{32};
}
