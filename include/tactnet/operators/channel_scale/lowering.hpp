#pragma once

#include <tactnet/operators/batch_norm/lowering.hpp>
#include <tactnet/operators/channel_scale/layer.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The factors of a channel scale, for the convolution before it or, after other layers, for a step of its
/// own.
template <class Place>
class scale_constants {
public:
    explicit scale_constants(const parameter_source& list) : values_(Place::parameters(list).values) {}
    [[nodiscard]] double factor(std::size_t channel) const { return static_cast<double>(values_[channel]); }
    [[nodiscard]] double shifted(std::size_t channel, double bias) const { return bias * factor(channel); }

private:
    const float* values_;
};

template <>
struct lowering<channel_scale> {
    template <class Place>
    using channels = scale_constants<Place>;
    template <class Place>
    using at = lowered_norm<Place, scale_constants<Place>>;
};

}} // namespace tactnet
