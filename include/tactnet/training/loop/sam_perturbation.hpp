#pragma once

#include <tactnet/training/loop/trainable.hpp>

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// For sharpness-aware minimisation (Foret et al., 2021): the network goes up the slope, the gradient is
/// taken there, and the network comes back to take its step. Where the loss is low all around, that gradient
/// is small; so wide valleys are found, and what is learnt in them holds for other images too.
class sam_perturbation {
public:
    /// Moves the parameters by `radius` in the direction of their gradient. One of zero moves nothing.
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
    /// Back, also to the statistics of before: those of the images count once.
    void come_back(trainable& network) const { network.take(values_, statistics_); }

private:
    std::vector<float> values_, statistics_;
};

} // namespace detail

} // namespace TACTNET_ARCH
} // namespace tactnet
