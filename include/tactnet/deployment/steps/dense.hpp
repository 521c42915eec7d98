#pragma once

#include <tactnet/deployment/steps/batch_executor.hpp>
#include <tactnet/deployment/steps/description.hpp>
#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/frame/dense.hpp>
#include <tactnet/kernels/panels/large_convolution.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <class Format, kernels::frame_dense Kernel>
struct dense_step;
template <class Format, kernels::frame_dense Kernel>
struct step_description<dense_step<Format, Kernel>> {
    static constexpr void visit(auto&& to) {
        to("tactnet::dense_step", "Dense", std::type_identity<Format>{}, Kernel);
    }
};

template <kernels::frame_dense Kernel>
struct dense_step<single_precision, Kernel> {
    using format = single_precision;
    static constexpr kernels::frame_dense kernel = Kernel;

private:
    static constexpr kernels::frame_convolution as_convolution{
        .window = {Kernel.input, {Kernel.input.rows, Kernel.input.columns}, 1},
        .filters = Kernel.outputs,
        .input_stride = Kernel.input_stride};
    static constexpr kernels::large_convolution large_plan{as_convolution};

public:
    /// Whether there are so many weights that it is computed by panels (kernels/panels), as a convolution
    /// with a kernel as large as the map: the networks for tactile images have fewer.
    static constexpr bool large =
        Kernel.outputs * Kernel.input.size() >= 1'000'000 && kernels::large_convolution::fits(as_convolution);
    static constexpr shape output{1, 1, Kernel.outputs};
    static constexpr std::size_t output_stride =
        large ? as_convolution.output_stride() : Kernel.output_stride();
    static constexpr std::size_t weights = Kernel.outputs * Kernel.input.size();
    static constexpr std::size_t folded = weights + Kernel.outputs;
    static constexpr std::size_t packed_weights =
        whole_lines(large ? large_plan.weights() : Kernel.weights());
    static constexpr std::size_t packed = packed_weights + whole_lines(output_stride);
    static constexpr std::size_t workspace_elements = large ? large_plan.scratch() : 0;

    static constexpr void pack(const float* from, float* to) {
        const auto weight = [&](std::size_t o, std::size_t channel, std::size_t pixel) {
            return from[(o * Kernel.input.channels + channel) * Kernel.input.area() + pixel];
        };
        if constexpr (large)
            large_plan.pack(to, [&](std::size_t o, std::size_t channel, std::size_t row, std::size_t column) {
                return weight(o, channel, row * Kernel.input.columns + column);
            });
        else
            kernels::pack_dense_weights<Kernel>(to, weight);
        std::copy_n(from + weights, Kernel.outputs, to + packed_weights);
    }
    static double output_bound(const float* from, double input) {
        return detail::largest_sum(from, Kernel.outputs, Kernel.input.size(), input);
    }
    static void run(const float* packed_values, const float* in, float* out,
                    [[maybe_unused]] float* memory) noexcept {
        if constexpr (large)
            run_share(packed_values, in, out, memory, {});
        else
            kernels::multiply_frames<Kernel>(in, 0, packed_values, packed_values + packed_weights, out, 0);
    }
    /// As many frames as registers allow read each weight once.
    template <class Executor>
    static void run_batch(const float* packed_values, const float* in, std::size_t in_distance, float* out,
                          float*, const Executor& executor) requires(!large) {
        constexpr std::size_t out_distance = detail::map_distance<dense_step>,
                              most = kernels::dense_frames<Kernel>;
        executor.pool.for_each((executor.frames + most - 1) / most, [&](std::size_t group) {
            const std::size_t first = group * most, count = std::min(most, executor.frames - first);
            kernels::unroll<most>([&](auto i) {
                if (count == i + 1)
                    kernels::multiply_frames<Kernel, i + 1>(in + first * in_distance, in_distance,
                                                            packed_values, packed_values + packed_weights,
                                                            out + first * out_distance, out_distance);
            });
        });
    }
    /// The share of one thread in a job.
    static void run_share(const float* packed_values, const float* in, float* out, float* memory,
                          const kernels::large_job& job) noexcept requires large {
        kernels::convolve_large(large_plan, job, in, packed_values, packed_values + packed_weights, out,
                                memory);
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
