#pragma once

#include <tactnet/image/resize.hpp>
#include <tactnet/image/three_channels.hpp>
#include <tactnet/kernels/integer/photograph.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

// The deployed steps of as_photograph. An exported network needs this file alone.

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

/// In 8 bits, for frames and for maps. The taps of the resize are whole multiples of 2⁻¹³ that sum to one, so
/// that all instruction sets give the same bytes.
template <class Input, extent2d From, std::size_t InputStride, extent2d To>
struct as_photograph_step<eight_bit_between<Input, std::uint8_t>, From, InputStride, To>
    : step_base<eight_bit, shape{To.rows, To.columns, 3}, 4> {
    static constexpr folded_arrays arrays{{"mean", folded_kind::numbers, {3}},
                                          {"factor", folded_kind::numbers, {3}},
                                          range_of_input,
                                          range_of_output};
    static constexpr std::size_t folded_elements = arrays.numbers();

private:
    using down = resize_axis<keys_cubic<>, From.rows, To.rows>;
    using along = resize_axis<keys_cubic<>, From.columns, To.columns>;
    using kernel = kernels::integer_photograph<down, along>;
    // The terms subtracted from the sums of red, green, blue and nothing, their factors, then two bytes.
    static constexpr std::size_t starts = 0, factors = 4 * sizeof(float), bytes = 2 * factors;
    /// Bytes get fractions of seven bits, as the words of frames have.
    static constexpr int shift = std::is_same_v<Input, std::uint8_t> ? 7 : 0;

public:
    static constexpr std::size_t packed_elements = pad_to_cache_line<std::int8_t>(bytes + 2),
                                 workspace_elements = pad_to_cache_line<std::uint8_t>(kernel::workspace *
                                                                                      sizeof(std::int32_t));

    static constexpr void pack(const float* from, std::int8_t* to) {
        const auto [input, added, result] = arrays.read_ranges(from);
        const double unit = static_cast<double>(input.scale) / (1 << shift) / kernel::one;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            detail::store_number(to + starts + channel * sizeof(float),
                                 static_cast<float>(static_cast<double>(from[channel]) / unit));
            detail::store_number(to + factors + channel * sizeof(float),
                                 static_cast<float>(unit * static_cast<double>(from[3 + channel]) /
                                                    static_cast<double>(result.scale)));
        }
        detail::store_byte(to + bytes, static_cast<double>(input.zero_point));
        detail::store_byte(to + bytes + 1, static_cast<double>(result.zero_point));
    }
    static void run(const std::int8_t* packed_values, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        using lanes = kernels::float_vec<4>;
        const std::int32_t zero = detail::load_byte(packed_values + bytes),
                           written = detail::load_byte(packed_values + bytes + 1);
        const auto* const from = reinterpret_cast<const Input*>(in);
        kernel::run([&](std::size_t pixel) { return (from[pixel * InputStride] - zero) * (1 << shift); },
                    kernels::load_bytes_as<lanes>(packed_values + starts),
                    kernels::load_bytes_as<lanes>(packed_values + factors), {0, 255, written},
                    reinterpret_cast<std::int32_t*>(memory), out);
    }
    /// For calibration: the same in single precision.
    static void reference(const float* folded, const float* in, float* out) {
        const tensor_view<const float, shape{From.rows, From.columns, 1}> grey(in);
        aligned_vector<float> resized(To.area());
        resize<shape{From.rows, From.columns, 1}, shape{To.rows, To.columns, 1}>(
            grey, tensor_view<float, shape{To.rows, To.columns, 1}>(resized.data()));
        for (std::size_t e = 0; e < 3 * To.area(); ++e)
            out[e] = (resized[e / 3] - folded[e % 3]) * folded[3 + e % 3];
    }
};

}} // namespace tactnet
