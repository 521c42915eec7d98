#pragma once

#include <tactnet/deployment/steps/batch_executor.hpp>
#include <tactnet/deployment/steps/description.hpp>
#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/frame/direct.hpp>
#include <tactnet/kernels/frame/packed_pixels.hpp>
#include <tactnet/kernels/frame/winograd.hpp>
#include <tactnet/kernels/panels/large_convolution.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Convolution with what follows it: batch norm, a sum, max pool, ReLU. The output may be some channels of a
/// wider map, beginning at Kernel.map_offset.
template <class Format, kernels::frame_convolution Kernel>
struct convolution_step;
template <class Format, kernels::frame_convolution Kernel>
struct step_description<convolution_step<Format, Kernel>> {
    static constexpr void visit(auto&& to) {
        to("tactnet::convolution_step", "Convolution", std::type_identity<Format>{}, Kernel);
    }
};

template <kernels::frame_convolution Kernel>
struct convolution_step<single_precision, Kernel> {
    static_assert(Kernel.groups > 0 && Kernel.window.input.channels % Kernel.groups == 0 &&
                      Kernel.filters % Kernel.groups == 0,
                  "convolution_step: groups must divide both channels and filters");
    static_assert(
        Kernel.separable_groups() || Kernel.ungrouped().fits_map(),
        "convolution_step: the output does not fit its place in the wider map: fits_map() says what "
        "it takes");
    static_assert(Kernel.map_stride == 0 || Kernel.map_offset + Kernel.filters <= Kernel.map_stride,
                  "convolution_step: the output reaches beyond the pixels of the wider map");

    using format = single_precision;
    static constexpr kernels::frame_convolution kernel = Kernel;
    /// Whether nobody else writes to the map.
    static constexpr bool fills_map = Kernel.map_stride == 0;
    static constexpr shape output{Kernel.output_rows(), Kernel.output_columns(), Kernel.filters};
    static constexpr std::size_t output_stride = Kernel.output_stride();
    static constexpr std::size_t weights = Kernel.filters * Kernel.taps();
    static constexpr std::size_t folded = weights + Kernel.filters;

private:
    /// Groups whose filters fill whole vectors are convolutions of their own, side by side. Others are one
    /// convolution with zeros between the groups.
    static constexpr std::size_t parts = Kernel.separable_groups() ? Kernel.groups : 1;
    static constexpr kernels::frame_convolution part =
        Kernel.separable_groups() ? Kernel.one_group() : Kernel.ungrouped();
    static constexpr kernels::large_convolution large_plan{part};
    using pixels = kernels::packed_pixels<part>;

public:
    /// Whether maps or weights are so large that it is computed by panels (kernels/panels).
    static constexpr bool large = kernels::large_convolution::suits(part);
    /// Pixels that share a vector, where taps are added to few filters.
    static constexpr std::size_t pixels_of_vector = !large && pixels::suits ? pixels::pixels : 1;
    /// Rows and columns of outputs that make a tile, where tiles take fewer operations than taps; else 0.
    static constexpr extent2d tile_outputs = large                  ? extent2d(large_plan.tiles.outputs)
                                             : pixels_of_vector > 1 ? extent2d(0)
                                                                    : kernels::best_tile(part);
    static constexpr bool tiled = tile_outputs != extent2d(0);
    static constexpr std::size_t packed_weights = [] {
        if constexpr (large)
            return whole_lines(large_plan.weights());
        else if constexpr (tiled)
            return whole_lines(kernels::winograd_tiles<part>::weights);
        else
            return whole_lines(pixels_of_vector > 1 ? pixels::weights : part.weights());
    }();
    static constexpr std::size_t packed_part =
        packed_weights + whole_lines(pixels_of_vector * part.padded_filters());
    static constexpr std::size_t packed = parts * packed_part;
    static constexpr std::size_t workspace_elements = [] {
        if constexpr (large)
            return large_plan.scratch();
        else if constexpr (tiled)
            return kernels::winograd_tiles<part>::scratch;
        else
            return pixels_of_vector > 1 ? pixels::scratch : 0;
    }();

    /// Frames whose tiles are computed together where there are so many; those left over pass alone. Not
    /// where groups are convolutions of their own, which nobody has asked for.
    static constexpr std::size_t frames_together = [] {
        if constexpr (tiled && !large && parts == 1)
            return kernels::frames_by_tiles<part>;
        else
            return std::size_t{1};
    }();

    static constexpr void pack(const float* from, float* to) {
        for (std::size_t p = 0; p < parts; ++p, to += packed_part) {
            const auto weight = [&](std::size_t filter, std::size_t channel, std::size_t row,
                                    std::size_t column) {
                return weight_of(from, p * part.filters + filter, p * part.window.input.channels + channel,
                                 row, column);
            };
            if constexpr (large)
                large_plan.pack(to, weight);
            else if constexpr (tiled)
                kernels::pack_winograd_weights<part>(to, weight);
            else if constexpr (pixels_of_vector > 1)
                kernels::pack_pixel_weights<part>(to, weight);
            else
                kernels::pack_frame_weights<part>(to, weight);
            const float* const biases = from + weights + p * part.filters;
            for (std::size_t pixel = 0; pixel < pixels_of_vector; ++pixel)
                std::copy_n(biases, part.filters, to + packed_weights + pixel * part.padded_filters());
        }
    }
    static double output_bound(const float* from, double input) {
        return detail::largest_sum(from, Kernel.filters, Kernel.taps(), input);
    }
    static void run(const float* packed_values, const float* in, float* out,
                    [[maybe_unused]] float* memory) noexcept {
        out += Kernel.map_offset;
        for (std::size_t p = 0; p < parts; ++p) {
            const float* const values = packed_values + p * packed_part;
            const float* const from = in + p * part.window.input.channels;
            float* const to = out + p * part.filters;
            if constexpr (large)
                kernels::convolve_large(large_plan, {}, from, values, values + packed_weights, to, memory);
            else if constexpr (tiled)
                kernels::convolve_frame_by_tiles<part>(from, values, values + packed_weights, to, memory);
            else if constexpr (pixels_of_vector > 1)
                kernels::convolve_packed_pixels<part>(from, values, values + packed_weights, to, memory);
            else
                kernels::convolve_frame<part>(from, values, values + packed_weights, to);
        }
    }
    /// The share of one thread in a job.
    static void run_share(const float* packed_values, const float* in, float* out, float* memory,
                          const kernels::large_job& job) noexcept requires large {
        out += Kernel.map_offset;
        for (std::size_t p = 0; p < parts; ++p) {
            const float* const values = packed_values + p * packed_part;
            kernels::convolve_large(large_plan, job, in + p * part.window.input.channels, values,
                                    values + packed_weights, out + p * part.filters, memory);
        }
    }

    /// The tiles of several frames as one list, while each thread has so many.
    template <class Executor>
    static void run_batch(const float* packed_values, const float* in, std::size_t in_distance, float* out,
                          float* memory, const Executor& executor) requires(frames_together > 1) {
        constexpr std::size_t some = frames_together, out_distance = detail::map_distance<convolution_step>;
        static_assert(kernels::winograd_tiles<part, tile_outputs, some>::scratch <=
                      some * workspace_elements);
        const auto alone = [&](std::size_t frame) {
            run(packed_values, in + frame * in_distance, out + frame * out_distance,
                memory + frame * workspace_elements);
        };
        if constexpr (Executor::most_frames >= some) {
            const std::size_t groups =
                executor.frames >= some * executor.threads() ? executor.frames / some : 0;
            const std::size_t left = executor.frames - groups * some;
            if (groups > 0)
                executor.pool.for_each(groups, [&](std::size_t group) {
                    const std::size_t first = group * some;
                    kernels::convolve_frames_by_tiles<part, tile_outputs, some>(
                        in + first * in_distance, in_distance, packed_values, packed_values + packed_weights,
                        out + first * out_distance + Kernel.map_offset, out_distance,
                        memory + first * workspace_elements);
                });
            if (left > 0)
                executor.pool.for_each(left, [&](std::size_t frame) { alone(groups * some + frame); });
        } else {
            executor.for_each_frame(alone);
        }
    }

private:
    /// Counted over all groups; zero for a channel of another group than the filter's.
    static constexpr float weight_of(const float* from, std::size_t filter, std::size_t channel,
                                     std::size_t row, std::size_t column) {
        constexpr extent2d k = Kernel.window.kernel;
        constexpr std::size_t channels = Kernel.window.input.channels / Kernel.groups;
        if constexpr (Kernel.groups > 1) {
            const std::size_t first = filter / (Kernel.filters / Kernel.groups) * channels;
            if (channel < first || channel >= first + channels)
                return 0.0f;
            channel -= first;
        }
        return from[((filter * channels + channel) * k.rows + row) * k.columns + column];
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
