#pragma once

#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/frame/elementwise.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// √(x + offset) − √offset, and 0 for x below 0. `Offset` is a std::ratio.
template <class Format, shape Map, std::size_t Stride, class Offset>
struct square_root_step;

template <shape Map, std::size_t Stride, class Offset>
struct square_root_step<single_precision, Map, Stride, Offset>
    : step_without_parameters<single_precision, Map, Stride> {
    static constexpr double offset = static_cast<double>(Offset::num) / static_cast<double>(Offset::den);

    /// x + offset must stay finite too, and roots of small numbers are larger than they.
    static double output_bound(const float*, double input) { return std::max(input, 1.0) + offset; }
    static void run(const float*, const float* in, float* out, float*) noexcept {
        kernels::shifted_roots<Map.area() * Stride>(static_cast<float>(offset), in, out);
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
