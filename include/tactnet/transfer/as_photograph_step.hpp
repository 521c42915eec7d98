#pragma once

#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/image/resize.hpp>
#include <tactnet/image/three_channels.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>

// The deployed step of as_photograph. An exported network needs this file alone.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Folded and packed: the mean of red, green and blue, then the factor of each after subtracting it.
template <class Format, extent2d From, std::size_t InputStride, extent2d To>
struct as_photograph_step;
template <class Format, extent2d From, std::size_t InputStride, extent2d To>
struct step_description<as_photograph_step<Format, From, InputStride, To>> {
    static constexpr const char* header = "tactnet/transfer/as_photograph_step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::as_photograph_step", "Photograph", std::type_identity<Format>{}, From,
           input_stride_argument{}, To);
    }
};

template <extent2d From, std::size_t InputStride, extent2d To>
struct as_photograph_step<single_precision, From, InputStride, To>
    : step_base<single_precision, shape{To.rows, To.columns, 3}, 3> {
    static constexpr shape grey{From.rows, From.columns, 1}, resized{To.rows, To.columns, 1};
    static constexpr std::size_t folded_elements = 6, packed_elements = pad_to_cache_line(folded_elements);
    static constexpr bool joins_pixels = InputStride != 1; ///< the input has gaps between its pixels
    static constexpr std::size_t workspace_elements =
        pad_to_cache_line(resized.area()) + (joins_pixels ? pad_to_cache_line(grey.area()) : 0);

    static constexpr void pack(const float* numbers, float* to) { std::copy_n(numbers, folded_elements, to); }
    /// More than the input: a bicubic kernel overshoots.
    static double output_bound(const float* numbers, double input) {
        const double most = input * gain<resize_axis<keys_cubic<>, From.rows, To.rows>>() *
                            gain<resize_axis<keys_cubic<>, From.columns, To.columns>>();
        double largest = most;
        for (std::size_t channel = 0; channel < 3; ++channel)
            largest = std::max(largest, (most + std::abs(static_cast<double>(numbers[channel]))) *
                                            std::abs(static_cast<double>(numbers[3 + channel])));
        return largest;
    }
    static void run(const float* numbers, const float* in, float* out, float* memory) noexcept {
        if constexpr (joins_pixels) {
            float* const joined = memory + pad_to_cache_line(resized.area());
            for (std::size_t pixel = 0; pixel < grey.area(); ++pixel)
                joined[pixel] = in[pixel * InputStride];
            in = joined;
        }
        resize<grey, resized>(tensor_view<const float, grey>(in), tensor_view<float, resized>(memory));
        const channel_normalisation normalise{{numbers[0], numbers[1], numbers[2]},
                                              {numbers[3], numbers[4], numbers[5]}};
        to_three_channels_last<resized>(tensor_view<const float, resized>(memory), normalise,
                                        std::span<float, 3 * resized.area()>(out, 3 * resized.area()));
    }

private:
    /// The largest factor by which resizing one axis may enlarge a value.
    template <class Axis>
    static double gain() {
        double most = 0;
        for (const auto& taps : Axis::table) {
            double sum = 0;
            for (const float weight : taps.weights)
                sum += std::abs(static_cast<double>(weight));
            most = std::max(most, sum);
        }
        return most;
    }
};

}} // namespace tactnet
