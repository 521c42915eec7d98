#pragma once

// Heads that are trained behind a frozen trunk, as methods.

#include "methods/method.hpp"
#include "methods/trunks/compiled.hpp"

#include <cstddef>
#include <memory>
#include <vector>

/// One for each trunk, for images of one size.
std::vector<std::unique_ptr<method>>
make_trunk_head_methods(std::size_t rows, std::size_t columns,
                        const std::vector<std::shared_ptr<const compiled_trunk>>& trunks);
