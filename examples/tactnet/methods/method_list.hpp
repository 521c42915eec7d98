#pragma once

// What the generated list of methods calls.

#include "methods/networks/compiled.hpp"
#include "methods/registry.hpp"
#include "methods/support_vector_machines/features.hpp"
#include "methods/trunks/compiled.hpp"

#include <tactnet/networks.hpp>
#include <tactnet/transfer/networks.hpp>

#include <memory>
#include <optional>
#include <vector>

/// Adds support vector machines on images of one size and, behind each of the trunks, support vector machines
/// and heads. `surf` makes the features of the paper's baseline.
void add_methods_behind_features(std::vector<std::unique_ptr<method>>& methods, tactnet::extent2d image,
                                 make_features* surf,
                                 const std::vector<std::shared_ptr<const compiled_trunk>>& trunks);
