#pragma once

#include "methods/training_settings.hpp"
#include "methods/weights.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

struct evaluate_options {
    training_settings training;
    weight_options weights;
    std::string data, results = "results", split = "both", images = "test";
    std::vector<std::string> methods, sizes;
    std::size_t splits = 10;
    std::uint64_t first_seed = 0;
    bool afresh = false; ///< forget earlier results
    std::size_t jobs = std::max(1U, std::thread::hardware_concurrency());
};

/// Tests a weight file instead of training. Gives the exit status.
int evaluate_weights(const evaluate_options& options);
