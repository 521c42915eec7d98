#pragma once

#include <tactnet/kernels/frame/sample_norm.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The norm by plain loops, for calibration and tests: maps are [pixel][channel], numbers of any type.
template <class Number>
void normalise_by_root_mean_square(const shape& map, const Number* weights, const Number& epsilon,
                                   const Number* in, Number* out) {
    using std::sqrt;
    const Number share = Number(1) / Number(static_cast<float>(map.channels));
    for (std::size_t e = 0; e < map.size(); e += map.channels) {
        Number squares(0);
        for (std::size_t c = 0; c < map.channels; ++c)
            squares = squares + in[e + c] * in[e + c];
        const Number inverse = Number(1) / sqrt(squares * share + epsilon);
        for (std::size_t c = 0; c < map.channels; ++c)
            out[e + c] = in[e + c] * inverse * weights[c];
    }
}

/// A root mean square norm of the channels of each pixel. Folded numbers: weights, epsilon.
template <class Format, shape Map, std::size_t Stride>
struct rms_norm_step;
template <class Format, shape Map, std::size_t Stride>
struct step_description<rms_norm_step<Format, Map, Stride>> {
    static constexpr const char* header = "tactnet/operators/rms_norm/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::rms_norm_step", "Root mean square norm", std::type_identity<Format>{}, Map,
           input_stride_argument{});
    }
};

template <shape Map, std::size_t Stride>
struct rms_norm_step<single_precision, Map, Stride> : step_base<single_precision, Map, Stride> {
    static constexpr std::size_t folded_elements = Map.channels + 1;
    static constexpr std::size_t packed_elements = pad_to_cache_line(Stride) + pad_to_cache_line(1);

    static constexpr void pack(const float* from, float* to) {
        std::copy_n(from, Map.channels, to);
        to[pad_to_cache_line(Stride)] = from[Map.channels];
    }
    /// No quotient exceeds √n of n channels. Before, the sum of their squares must stay finite: where it
    /// would be large, that is the bound.
    static double output_bound(const float* from, double input) {
        constexpr double largest_square = 1e30;
        constexpr auto count = static_cast<double>(Map.channels);
        double largest = 0;
        for (std::size_t c = 0; c < Map.channels; ++c)
            largest = std::max(largest, std::abs(static_cast<double>(from[c])));
        const double squares = count * input * input;
        return squares < largest_square ? largest * std::sqrt(count) : squares;
    }
    static void run(const float* packed_values, const float* in, float* out, float*) noexcept {
        using vector = typename decltype(kernels::pixel_vector<float, Stride>())::type;
        using access = kernels::pixel_access<vector>;
        constexpr std::size_t width = sizeof(vector) / sizeof(float);
        constexpr float share = 1 / static_cast<float>(Map.channels);
        const float epsilon = packed_values[pad_to_cache_line(Stride)];
        for (std::size_t e = 0; e < Map.area() * Stride; e += Stride) {
            vector squares(0.0F);
            for (std::size_t v = 0; v < Stride; v += width) {
                const vector x = access::load(in + e + v);
                squares = kernels::fused_multiply_add(x, x, squares);
            }
            const vector inverse(1 / std::sqrt(kernels::sum_of_lanes(squares) * share + epsilon));
            for (std::size_t v = 0; v < Stride; v += width)
                access::store(out + e + v,
                              access::load(in + e + v) * inverse * access::load(packed_values + v));
        }
    }
};

}} // namespace tactnet
