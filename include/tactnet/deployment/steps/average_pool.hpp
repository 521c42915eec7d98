#pragma once

#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/frame/pooling.hpp>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// An average pool.
template <class Format, average_windows Windows, std::size_t Channels, std::size_t Stride>
struct average_pool_step;

template <average_windows Windows, std::size_t Channels, std::size_t Stride>
struct average_pool_step<single_precision, Windows, Channels, Stride>
    : step_without_parameters<single_precision,
                              shape{Windows.rows.outputs, Windows.columns.outputs, Channels}, Stride> {
    static void run(const float*, const float* in, float* out, float*) noexcept {
        kernels::average_frame<Stride>(Windows, in, out);
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
