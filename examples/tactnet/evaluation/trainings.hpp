#pragma once

// The trainings of an evaluation, many at once.

#include "data/image_data.hpp"
#include "evaluation/results.hpp"
#include "methods/method.hpp"
#include "methods/training_settings.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

/// A method with the images of its size.
struct candidate {
    const method* what;
    training_settings training;
    const image_data* data;
    std::shared_ptr<const trained_method> start{};
    std::shared_ptr<pretrained_weights> pretrained{};
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

/// Runs the tasks side by side, each on one thread; results are kept as they come. Several programs on one
/// file of results share the tasks. False if interrupted. Trainings that diverge are added to `diverged` and
/// left out; without such a list the first one ends all.
bool run_all(const std::vector<task>& tasks, std::size_t jobs, result_list& results,
             std::vector<std::string>* diverged = nullptr);
