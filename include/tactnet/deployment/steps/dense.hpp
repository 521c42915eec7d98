#pragma once

#include <tactnet/deployment/steps/batch_executor.hpp>
#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/frame/methods.hpp>

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
    using method = kernels::dense_method<Kernel>;
    static constexpr kernels::frame_dense kernel = Kernel;
    static constexpr bool large = method::large;
    static constexpr shape output{1, 1, Kernel.outputs};
    static constexpr std::size_t output_stride = method::output_stride;
    static constexpr std::size_t weights = Kernel.outputs * Kernel.input.size();
    static constexpr std::size_t folded = weights + Kernel.outputs;
    static constexpr std::size_t packed = method::packed_elements;
    static constexpr std::size_t workspace_elements = method::workspace_elements;

    static constexpr void pack(const float* from, float* to) {
        const auto weight = [&](std::size_t o, std::size_t channel, std::size_t pixel) {
            return from[(o * Kernel.input.channels + channel) * Kernel.input.area() + pixel];
        };
        method::pack(weight, from + weights, to);
    }
    static double output_bound(const float* from, double input) {
        return detail::largest_sum(from, Kernel.outputs, Kernel.input.size(), input);
    }
    static void run(const float* packed_values, const float* in, float* out, float* workspace) noexcept {
        method::run(packed_values, in, out, workspace);
    }
    /// As many frames as registers allow read each weight once.
    template <class Executor>
    static void run_batch(const float* packed_values, const float* in, std::size_t in_distance, float* out,
                          float*, const Executor& executor) requires(!large) {
        constexpr std::size_t out_distance = detail::map_distance<dense_step>, most = method::frames_together;
        executor.pool.for_each((executor.frames + most - 1) / most, [&](std::size_t call) {
            const std::size_t first = call * most, count = std::min(most, executor.frames - first);
            method::run_frames(count, packed_values, in + first * in_distance, in_distance,
                               out + first * out_distance, out_distance);
        });
    }
    /// The share of one thread in a job.
    static void run_share(const float* packed_values, const float* in, float* out, float* workspace,
                          const kernels::large_job& job) noexcept requires large {
        method::run_share(packed_values, in, out, workspace, job);
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
