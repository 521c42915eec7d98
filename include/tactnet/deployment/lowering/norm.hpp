#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/deployment/steps/norm.hpp>
#include <tactnet/layers/batch_norm.hpp>

#include <cmath>
#include <cstddef>
#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A batch norm with its running statistics: x · factor + offset.
template <class Place>
class norm_constants {
public:
    explicit norm_constants(const parameter_source& list) : from_(Place::parameters(list)) {}
    [[nodiscard]] double factor(std::size_t channel) const {
        return static_cast<double>(from_.values[channel]) /
               std::sqrt(static_cast<double>(from_.statistics[channels + channel]) + from_.epsilon);
    }
    /// What becomes of a bias in front of the norm.
    [[nodiscard]] double shifted(std::size_t channel, double bias) const {
        return (bias - static_cast<double>(from_.statistics[channel])) * factor(channel) +
               static_cast<double>(from_.values[channels + channel]);
    }

private:
    static constexpr std::size_t channels = Place::layer::output.channels;
    parameter_source from_;
};

/// A batch norm that no convolution has taken up, with the ReLU behind it.
template <class Place, bool Rectified = false>
struct lowered_norm {
    using step = norm_step<typename Place::format, Place::layer::output, Place::input_stride, Rectified>;

    static void fold(const parameter_source& list, float* to) {
        const norm_constants<Place> norm(list);
        for (std::size_t c = 0; c < step::output.channels; ++c) {
            to[c] = static_cast<float>(norm.factor(c));
            to[step::output.channels + c] = static_cast<float>(norm.shifted(c, 0));
        }
    }
    template <class Spec, class>
    static constexpr auto fuse() {
        if constexpr (rectifies<Spec>)
            return std::type_identity<lowered_norm<Place, true>>{};
        else
            return not_fused{};
    }
};

template <>
struct lowering<batch_norm> {
    template <class Place>
    using channels = norm_constants<Place>;
    template <class Place>
    using at = lowered_norm<Place>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
