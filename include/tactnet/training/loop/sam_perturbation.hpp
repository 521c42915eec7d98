#pragma once

#include <tactnet/training/loop/trainable.hpp>

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// The perturbation of sharpness-aware minimisation (Foret et al., 2021): parameters move along their
/// gradient, the gradient for the step is taken there, and the parameters move back. That gradient is small
/// if the loss is low all around, so training finds wide minima, which generalise better.
class sam_perturbation {
public:
    /// Moves the parameters by `radius` in the direction of their gradient. A zero gradient moves nothing.
    void climb(trainable& network, std::span<const float> gradients, double radius) {
        const std::span<float> values = network.learnable_values();
        const std::span<const float> statistics = network.running_statistics();
        values_.assign(values.begin(), values.end());
        statistics_.assign(statistics.begin(), statistics.end());
        double squares = 0;
        for (const float g : gradients)
            squares += static_cast<double>(g) * static_cast<double>(g);
        if (squares == 0)
            return;
        const auto step = static_cast<float>(radius / std::sqrt(squares));
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] += step * gradients[i];
    }
    /// Restores parameters and statistics, so that each image counts once in the statistics.
    void come_back(trainable& network) const { network.take(values_, statistics_); }

private:
    std::vector<float> values_, statistics_;
};

} // namespace detail

} // namespace TACTNET_ARCH
} // namespace tactnet
