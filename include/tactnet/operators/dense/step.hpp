#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/frame/methods.hpp>
#include <tactnet/lowering/batch_executor.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A dense layer.
template <class Format, kernels::frame_dense Kernel>
struct dense_step;
template <class Format, kernels::frame_dense Kernel>
struct step_description<dense_step<Format, Kernel>> {
    static constexpr const char* header = "tactnet/operators/dense/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::dense_step", "Dense", std::type_identity<Format>{}, Kernel);
    }
};

template <kernels::frame_dense Kernel>
struct dense_step<single_precision, Kernel>
    : step_base<single_precision, shape{1, 1, Kernel.outputs}, kernels::dense_method<Kernel>::output_stride> {
    using method = kernels::dense_method<Kernel>;
    static constexpr kernels::frame_dense kernel = Kernel;
    static constexpr bool layerwise = method::layerwise;
    static constexpr std::size_t weights = Kernel.outputs * Kernel.input.size();
    static constexpr std::size_t folded_elements = weights + Kernel.outputs;
    static constexpr std::size_t packed_elements = method::packed_elements;
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
                          float*, const Executor& executor)
        requires(!layerwise)
    {
        constexpr std::size_t out_distance = detail::map_distance<dense_step>, most = method::frames_together;
        executor.pool.for_each(detail::ceil_div(executor.frames, most), [&](std::size_t call) {
            const std::size_t first = call * most, count = std::min(most, executor.frames - first);
            method::run_frames(count, packed_values, in + first * in_distance, in_distance,
                               out + first * out_distance, out_distance);
        });
    }
    /// The share of one thread in a job.
    static void run_share(const float* packed_values, const float* in, float* out, float* workspace,
                          const kernels::layerwise_job& job) noexcept
        requires layerwise
    {
        method::run_share(packed_values, in, out, workspace, job);
    }
};

}} // namespace tactnet
