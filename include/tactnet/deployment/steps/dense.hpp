#pragma once

#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/frame/dense.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <class Format, kernels::frame_dense Kernel>
struct dense_step;

template <kernels::frame_dense Kernel>
struct dense_step<single_precision, Kernel> {
    using format = single_precision;
    static constexpr kernels::frame_dense kernel = Kernel;
    static constexpr shape output{1, 1, Kernel.outputs};
    static constexpr std::size_t output_stride = Kernel.output_stride();
    static constexpr std::size_t weights = Kernel.outputs * Kernel.input.size();
    static constexpr std::size_t folded = weights + Kernel.outputs;
    static constexpr std::size_t packed_weights = whole_lines(Kernel.weights());
    static constexpr std::size_t packed = packed_weights + whole_lines(output_stride);
    static constexpr std::size_t scratch = 0;

    static constexpr void pack(const float* from, float* to) {
        kernels::pack_dense_weights<Kernel>(to, [&](std::size_t o, std::size_t channel, std::size_t pixel) {
            return from[(o * Kernel.input.channels + channel) * Kernel.input.area() + pixel];
        });
        std::copy_n(from + weights, Kernel.outputs, to + packed_weights);
    }
    static double reach(const float* from, double input) {
        return detail::largest_sum(from, Kernel.outputs, Kernel.input.size(), input);
    }
    static void run(const float* packed_values, const float* in, float* out, float*) noexcept {
        kernels::multiply_frame<Kernel>(in, packed_values, packed_values + packed_weights, out);
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
