#pragma once

// A network as one writes it first: loops in single precision, sums from the first term to the last, batch
// norms by their formula, no step of them folded or reordered. What hard cases are told beside.

#include <span>
#include <support/layers/deployment_bound.hpp>
#include <vector>

namespace hard_cases {

/// Of one frame, [channel][row][column].
[[nodiscard]] std::vector<float> plain_outputs(const std::vector<support::described_layer>& layers,
                                               const support::described_parameters& parameters,
                                               std::vector<float> in);

/// The same layers where nothing is folded and no convolution is computed by tiles: the bound of batches.
[[nodiscard]] std::vector<support::described_layer> as_trained(std::vector<support::described_layer> layers);

} // namespace hard_cases
