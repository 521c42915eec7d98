#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/batch_norm/layer.hpp>
#include <tactnet/operators/batch_norm/step.hpp>

#include <cmath>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The factor and the offset of a batch norm, from its running statistics.
template <class Place>
class norm_constants {
public:
    explicit norm_constants(const parameter_source& list) : from_(Place::parameters(list)) {}
    [[nodiscard]] double factor(std::size_t channel) const {
        return static_cast<double>(from_.values[channel]) /
               std::sqrt(static_cast<double>(from_.statistics[channels + channel]) + from_.epsilon);
    }
    /// The bias of a convolution before the norm, after the norm.
    [[nodiscard]] double shifted(std::size_t channel, double bias) const {
        return (bias - static_cast<double>(from_.statistics[channel])) * factor(channel) +
               static_cast<double>(from_.values[channels + channel]);
    }

private:
    static constexpr std::size_t channels = Place::layer::output.channels;
    parameter_source from_;
};

/// A batch norm that no convolution has fused, with the ReLU after it. `Norm` has its constants.
template <class Place, class Norm = norm_constants<Place>, bool Rectified = false>
struct lowered_norm {
    using step = norm_step<typename Place::format, Place::layer::output, Place::input_stride, Rectified>;

    static void fold(const parameter_source& list, float* to) {
        const Norm norm(list);
        for (std::size_t c = 0; c < step::output.channels; ++c) {
            to[c] = static_cast<float>(norm.factor(c));
            to[step::output.channels + c] = static_cast<float>(norm.shifted(c, 0));
        }
    }
    template <class Spec, class>
    static constexpr auto fuse() {
        return fuse_relu<Spec, lowered_norm<Place, Norm, true>>();
    }
};

template <>
struct lowering<batch_norm> {
    template <class Place>
    using channels = norm_constants<Place>;
    template <class Place>
    using at = lowered_norm<Place>;
};

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
