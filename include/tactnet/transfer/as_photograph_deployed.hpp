#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/transfer/as_photograph.hpp>
#include <tactnet/transfer/as_photograph_step.hpp>

#include <cmath>
#include <cstddef>

// Lowers as_photograph to its deployed step.

namespace tactnet {
inline namespace TACTNET_ARCH {

template <extent2d Size>
struct lowering<as_photograph<Size>> {
    template <class Place>
    struct at {
        using step = as_photograph_step<typename Place::format,
                                        extent2d{Place::layer::input.rows, Place::layer::input.columns},
                                        Place::input_stride, Size>;
        static void fold(const parameter_source& list, float* to) {
            const float* const statistics = Place::parameters(list).statistics;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                to[channel] = statistics[channel];
                to[3 + channel] =
                    static_cast<float>(1 / std::sqrt(static_cast<double>(statistics[3 + channel])));
            }
        }
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet
