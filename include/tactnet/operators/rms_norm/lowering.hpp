#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/rms_norm/layer.hpp>
#include <tactnet/operators/rms_norm/step.hpp>

#include <algorithm>
#include <limits>

namespace tactnet { inline namespace TACTNET_ARCH {

template <>
struct lowering<rms_norm> {
    /// What the layer computes, for tests.
    static void compute(const auto&... arguments) { normalise_by_root_mean_square(arguments...); }

    template <class Place>
    struct at {
        using step = rms_norm_step<typename Place::format, Place::output, Place::input_stride>;

        /// Without an epsilon above zero, zeros have no finite norm: NaN is rejected as a parameter.
        static void fold(const parameter_source& list, float* to) {
            const parameter_source from = Place::parameters(list);
            const auto epsilon = static_cast<float>(from.epsilon);
            *std::copy_n(from.values, Place::layer::parameters, to) =
                epsilon > 0 ? epsilon : std::numeric_limits<float>::quiet_NaN();
        }
    };
};

}} // namespace tactnet
