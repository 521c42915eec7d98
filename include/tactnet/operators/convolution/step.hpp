#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/frame/methods.hpp>
#include <tactnet/lowering/batch_executor.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Convolution with its epilogue: batch norm, a sum, max pool, activation function. The output may be some
/// channels of a wider map, beginning at Kernel.map_offset.
template <class Format, kernels::frame_convolution Kernel>
struct convolution_step;
template <class Format, kernels::frame_convolution Kernel>
struct step_description<convolution_step<Format, Kernel>> {
    static constexpr const char* header = "tactnet/operators/convolution/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::convolution_step", "Convolution", std::type_identity<Format>{}, Kernel);
    }
};

template <kernels::frame_convolution Kernel>
struct convolution_step<single_precision, Kernel>
    : step_base<single_precision, shape{Kernel.output_rows(), Kernel.output_columns(), Kernel.filters},
                Kernel.output_stride()> {
    static_assert(Kernel.groups > 0 && Kernel.window.input.channels % Kernel.groups == 0 &&
                      Kernel.filters % Kernel.groups == 0,
                  "convolution_step: groups must divide both channels and filters");
    static_assert(
        Kernel.separable_groups() || Kernel.ungrouped().fits_map(),
        "convolution_step: the output does not fit its place in the wider map: fits_map() says what "
        "it takes");
    static_assert(Kernel.map_stride == 0 || Kernel.map_offset + Kernel.filters <= Kernel.map_stride,
                  "convolution_step: the output reaches beyond the pixels of the wider map");
    static_assert(!Kernel.activation->moves_zero || Kernel.padded_filters() == Kernel.filters,
                  "convolution_step: a function that is not zero at zero needs filters that fill all lanes");

    using method = kernels::convolution_method<Kernel>;
    static constexpr kernels::frame_convolution kernel = Kernel;
    /// Whether no other step writes to the map.
    static constexpr bool fills_map = Kernel.map_stride == 0;
    static constexpr bool layerwise = method::layerwise;
    static constexpr std::size_t weights = Kernel.filters * Kernel.taps();
    static constexpr std::size_t folded_elements = weights + Kernel.filters;
    static constexpr std::size_t packed_elements = method::packed_elements;
    static constexpr std::size_t workspace_elements = method::workspace_elements;
    static constexpr const kernels::fused_activation* after_sum =
        Kernel.accumulates ? Kernel.activation : &kernels::no_activation;
    static constexpr double largest_output = Kernel.activation->largest_value;

    static constexpr void pack(const float* from, float* to) {
        const auto weight = [&](std::size_t filter, std::size_t channel, std::size_t row,
                                std::size_t column) {
            constexpr extent2d k = Kernel.window.kernel;
            return from[filter * Kernel.taps() + (channel * k.rows + row) * k.columns + column];
        };
        method::pack(weight, from + weights, to);
    }
    static double output_bound(const float* from, double input) {
        const double sum = detail::largest_sum(from, Kernel.filters, Kernel.taps(), input);
        if constexpr (Kernel.activation->exists && !Kernel.accumulates)
            return Kernel.activation->output_bound(sum);
        else
            return sum;
    }
    static void run(const float* packed_values, const float* in, float* out, float* workspace) noexcept {
        method::run(packed_values, in, out + Kernel.map_offset, workspace);
    }
    /// The share of one thread in a job.
    static void run_share(const float* packed_values, const float* in, float* out, float* workspace,
                          const kernels::layerwise_job& job) noexcept
        requires layerwise
    {
        method::run_share(packed_values, in, out + Kernel.map_offset, workspace, job);
    }
    /// Several frames in each call of the method while every thread has so many, then the others one by one.
    template <class Executor>
    static void run_batch(const float* packed_values, const float* in, std::size_t in_distance, float* out,
                          float* workspace, const Executor& executor)
        requires(method::frames_together > 1)
    {
        constexpr std::size_t some = method::frames_together,
                              out_distance = detail::map_distance<convolution_step>;
        const std::size_t calls = Executor::max_frames >= some && executor.frames >= some * executor.threads()
                                      ? executor.frames / some
                                      : 0;
        if constexpr (Executor::max_frames >= some)
            if (calls > 0)
                executor.pool.for_each(calls, [&](std::size_t call) {
                    const std::size_t first = call * some;
                    method::run_frames(packed_values, in + first * in_distance, in_distance,
                                       out + first * out_distance + Kernel.map_offset, out_distance,
                                       workspace + first * workspace_elements);
                });
        const std::size_t done = calls * some;
        if (done < executor.frames)
            executor.pool.for_each(executor.frames - done, [&](std::size_t i) {
                const std::size_t frame = done + i;
                run(packed_values, in + frame * in_distance, out + frame * out_distance,
                    workspace + frame * workspace_elements);
            });
    }
};

}} // namespace tactnet
