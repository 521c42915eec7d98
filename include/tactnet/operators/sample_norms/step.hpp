#pragma once

#include <tactnet/kernels/frame/elementwise.hpp>
#include <tactnet/kernels/frame/sample_norm.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// What a deployed norm with moments of its own for each frame normalises together: groups of channels, the
/// frame with a weight for each element, or the channels of each pixel.
enum class sample_norm_kind : unsigned { groups, frame, pixels };

/// A group, instance or layer norm, with or without ReLU. `Groups` counts the groups of channels, and `Kind`
/// is a sample_norm_kind. Folded numbers: weights, biases ([channel], or [channel][row][column] for a frame),
/// epsilon.
template <class Format, shape Map, std::size_t Stride, unsigned Kind, std::size_t Groups, bool Rectified>
struct sample_norm_step;
template <class Format, shape Map, std::size_t Stride, unsigned Kind, std::size_t Groups, bool Rectified>
struct step_description<sample_norm_step<Format, Map, Stride, Kind, Groups, Rectified>> {
    static constexpr const char* header = "tactnet/operators/sample_norms/step.hpp";
    static constexpr void visit(auto&& to) {
        constexpr bool of_groups = static_cast<sample_norm_kind>(Kind) == sample_norm_kind::groups;
        to("tactnet::sample_norm_step",
           of_groups ? (Rectified ? "Group norm, ReLU" : "Group norm")
                     : (Rectified ? "Layer norm, ReLU" : "Layer norm"),
           std::type_identity<Format>{}, Map, input_stride_argument{}, Kind, Groups, Rectified);
    }
};

template <shape Map, std::size_t Stride, unsigned Kind, std::size_t Groups, bool Rectified>
struct sample_norm_step<single_precision, Map, Stride, Kind, Groups, Rectified>
    : step_base<single_precision, Map, Stride> {
private:
    static constexpr auto kind = static_cast<sample_norm_kind>(Kind);
    static constexpr kernels::frame_norm norm{.pixels = Map.area(),
                                              .channels = Map.channels,
                                              .stride = Stride,
                                              .groups = Groups,
                                              .weight_per_element = kind == sample_norm_kind::frame,
                                              .rectified = Rectified};
    static constexpr std::size_t weights = norm.weight_per_element ? Map.size() : Map.channels,
                                 packed_weights = pad_to_cache_line(
                                     norm.weight_per_element ? Map.area() * Stride : Stride);
    static constexpr std::size_t values_together =
        kind == sample_norm_kind::pixels ? Map.channels : Map.channels / Groups * Map.area();
    static constexpr std::size_t room = pad_to_cache_line(Stride);

public:
    static constexpr std::size_t folded_elements = 2 * weights + 1;
    static constexpr std::size_t packed_elements = 2 * packed_weights + pad_to_cache_line(1);
    static constexpr std::size_t workspace_elements =
        kind == sample_norm_kind::pixels ? 0 : kernels::group_norm_memory::arrays * room;

    static constexpr void pack(const float* from, float* to) {
        for (std::size_t w = 0; w < weights; ++w) {
            const std::size_t place = norm.weight_per_element ? w % Map.area() * Stride + w / Map.area() : w;
            to[place] = from[w];
            to[packed_weights + place] = from[weights + w];
        }
        to[2 * packed_weights] = from[2 * weights];
    }
    /// No normalised value exceeds √(n − 1) of n values. Before, the sum of the squares of n distances, each
    /// up to twice the input, must stay finite: where it would be large, that is the bound.
    static double output_bound(const float* from, double input) {
        constexpr double largest_square = 1e30;
        constexpr auto count = static_cast<double>(values_together);
        const double squares = 4 * count * input * input;
        if (!(squares < largest_square))
            return squares;
        return detail::largest_sum(from, weights, 1, std::sqrt(count));
    }
    static void run(const float* packed_values, const float* in, float* out, float* memory) noexcept {
        using wide = typename decltype(kernels::pixel_vector<float, Stride>())::type;
        const float *biases = packed_values + packed_weights, *epsilon = biases + packed_weights;
        if constexpr (kind == sample_norm_kind::pixels)
            kernels::normalise_each_pixel<wide>(norm, packed_values, biases, *epsilon, in, out);
        else
            kernels::normalise_channel_groups<wide>(norm, packed_values, biases, *epsilon, in, out,
                                                    kernels::group_norm_memory(memory, room));
    }
};

/// Local response normalisation. `Rule` is a kernels::response_rule.
template <class Format, shape Map, std::size_t Stride, class Rule>
struct local_response_norm_step;
template <class Format, shape Map, std::size_t Stride, class Rule>
struct step_description<local_response_norm_step<Format, Map, Stride, Rule>> {
    static constexpr const char* header = "tactnet/operators/sample_norms/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::local_response_norm_step", "Local response normalisation", std::type_identity<Format>{},
           Map, input_stride_argument{}, std::type_identity<Rule>{});
    }
};

template <shape Map, std::size_t Stride, class Rule>
struct local_response_norm_step<single_precision, Map, Stride, Rule>
    : step_base<single_precision, Map, Stride> {
    /// Squares must stay finite, and so must x · k^−β.
    static double output_bound(const float*, double input) {
        return std::max(
            {input, input * std::pow(Rule::k, -Rule::beta), static_cast<double>(Rule::size) * input * input});
    }
    static void run(const float*, const float* in, float* out, float*) noexcept {
        kernels::normalise_pixels<Rule, Stride>(Map.area(), in, out);
    }
};

}} // namespace tactnet
