#pragma once

// Support vector machines among the program's methods: on pixels, and behind histograms of SURF words as in
// the paper's baseline.

#include "methods/method.hpp"
#include "methods/support_vector_machines/image_features.hpp"

#include <cstddef>
#include <memory>
#include <vector>

/// Those for images of one size; `surf` makes the features of the paper's baseline, which are compiled for
/// that size.
std::vector<std::unique_ptr<method>> make_svm_methods(std::size_t rows, std::size_t columns,
                                                      std::unique_ptr<image_features> (*surf)());
