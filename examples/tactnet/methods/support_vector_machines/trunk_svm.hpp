#pragma once

// Support vector machines behind a network that was trained on photographs: the paper's SqueezeNet-SVM,
// AlexNet-SVM, ResNet50-SVM and VGG16-SVM, and what does better than these.

#include "methods/method.hpp"
#include "methods/trunks/compiled.hpp"

#include <cstddef>
#include <memory>
#include <vector>

/// Those for images of one size, behind those of the trunks that were compiled in.
std::vector<std::unique_ptr<method>>
make_trunk_svm_methods(std::size_t rows, std::size_t columns,
                       const std::vector<std::shared_ptr<const compiled_trunk>>& trunks);
