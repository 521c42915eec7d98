#pragma once

#include <tactnet/tensor/shape.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Tekscan's 6077 sensor with the electronics of Gandarias et al. 2019, which recorded the paper's images:
/// the defaults of calibration and of simulated arrays.
struct tekscan_6077 {
    static constexpr shape extents{28, 50, 1};
    static constexpr double saturation_pressure = 34e3; ///< pascal
    static constexpr double tactels_per_area = 27.6e4;  ///< per square metre; 27.6 per square centimetre
    static constexpr double pitch = 1.903e-3; ///< metres from tactel to tactel: 1 / √tactels_per_area
};

}} // namespace tactnet
