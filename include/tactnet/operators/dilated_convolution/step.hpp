#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/dilated_axis.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The start of a dilated convolution: puts the pixels of each phase together in one map, with zeros
/// between the phases (kernels/dilated_axis.hpp).
template <class Format, sliding_window Window, extent2d Dilation, extent2d Outputs, std::size_t InputStride>
struct phase_splitting_step;
template <class Format, sliding_window Window, extent2d Dilation, extent2d Outputs, std::size_t InputStride>
struct step_description<phase_splitting_step<Format, Window, Dilation, Outputs, InputStride>> {
    static constexpr const char* header = "tactnet/operators/dilated_convolution/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::phase_splitting_step", "Phases of a dilated convolution", std::type_identity<Format>{},
           Window, Dilation, Outputs, input_stride_argument{});
    }
};

namespace detail {

/// In every number format.
template <class Format, sliding_window Window, extent2d Dilation, extent2d Outputs, std::size_t InputStride>
struct phase_splitting
    : step_base<Format, kernels::dilated_phases<Window, Dilation, Outputs>::map, InputStride> {
    template <std::size_t Elements, class T>
    static void split(const T* in, T zero, T* out) {
        using phases = kernels::dilated_phases<Window, Dilation, Outputs>;
        kernels::gather_pixels<Elements, Window.input.columns>(phases::rows::input_at,
                                                               phases::columns::input_at, in, zero, out);
    }
};

} // namespace detail

template <sliding_window Window, extent2d Dilation, extent2d Outputs, std::size_t InputStride>
struct phase_splitting_step<single_precision, Window, Dilation, Outputs, InputStride>
    : detail::phase_splitting<single_precision, Window, Dilation, Outputs, InputStride> {
    static void run(const float*, const float* in, float* out, float*) noexcept {
        phase_splitting_step::template split<InputStride>(in, 0.0F, out);
    }
};

/// The end of a dilated convolution: puts the outputs of the phases in their places. In every number format.
template <class Format, sliding_window Window, extent2d Dilation, extent2d Outputs, std::size_t Filters,
          std::size_t InputStride>
struct phase_merging_step : step_base<Format, shape{Outputs.rows, Outputs.columns, Filters}, InputStride> {
    using number = typename Format::activation;
    static constexpr bool keeps_values = true;

    static void run(const typename Format::packed_number*, const number* in, number* out, number*) noexcept {
        merge<InputStride>(in, out);
    }
    /// For calibration.
    static void reference(const float*, const float* in, float* out) { merge<Filters>(in, out); }

private:
    template <std::size_t Elements, class T>
    static void merge(const T* in, T* out) {
        using phases = kernels::dilated_phases<Window, Dilation, Outputs>;
        kernels::gather_pixels<Elements, phases::layout.along.sums()>(phases::rows::sum_of,
                                                                      phases::columns::sum_of, in, T{}, out);
    }
};
template <class Format, sliding_window Window, extent2d Dilation, extent2d Outputs, std::size_t Filters,
          std::size_t InputStride>
struct step_description<phase_merging_step<Format, Window, Dilation, Outputs, Filters, InputStride>> {
    static constexpr const char* header = "tactnet/operators/dilated_convolution/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::phase_merging_step", "Outputs of a dilated convolution", std::type_identity<Format>{},
           Window, Dilation, Outputs, Filters, input_stride_argument{});
    }
};

namespace detail {

/// Elements from one pixel to the next of a map of so many filters: whole vectors, as of convolutions.
template <std::size_t Filters>
inline constexpr std::size_t filter_stride = round_up(Filters, kernels::lanes_for<float>(Filters));

} // namespace detail

/// The end of a transposed convolution: a pixel of the input holds Stride.rows × Stride.columns pixels of the
/// output, one after the other ([row][column][filter]), and they are put in their places. `Skipped` rows and
/// columns, fewer than the stride, are left out at the top and on the left. In every number format.
template <class Format, shape Map, extent2d Stride, extent2d Skipped, extent2d Output,
          std::size_t InputStride>
struct phase_interleaving_step
    : step_base<Format, shape{Output.rows, Output.columns, Map.channels / Stride.area()},
                detail::filter_stride<Map.channels / Stride.area()>> {
    using number = typename Format::activation;
    static constexpr bool keeps_values = true;
    static constexpr std::size_t filters = Map.channels / Stride.area();

    static void run(const typename Format::packed_number*, const number* in, number* out, number*) noexcept {
        interleave<InputStride, detail::filter_stride<filters>>(in, out);
    }
    /// For calibration.
    static void reference(const float*, const float* in, float* out) {
        interleave<Map.channels, filters>(in, out);
    }

private:
    template <std::size_t From, std::size_t To, class T>
    static void interleave(const T* in, T* out) {
        for (std::size_t y = Skipped.rows; y < Output.rows + Skipped.rows; ++y)
            for (std::size_t x = Skipped.columns; x < Output.columns + Skipped.columns; ++x, out += To) {
                const std::size_t pixel = y / Stride.rows * Map.columns + x / Stride.columns,
                                  phase = y % Stride.rows * Stride.columns + x % Stride.columns;
                std::copy_n(in + pixel * From + phase * filters, filters, out);
                std::fill(out + filters, out + To, T{});
            }
    }
};
template <class Format, shape Map, extent2d Stride, extent2d Skipped, extent2d Output,
          std::size_t InputStride>
struct step_description<phase_interleaving_step<Format, Map, Stride, Skipped, Output, InputStride>> {
    static constexpr const char* header = "tactnet/operators/dilated_convolution/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::phase_interleaving_step", "Phases of a transposed convolution",
           std::type_identity<Format>{}, Map, Stride, Skipped, Output, input_stride_argument{});
    }
};

}} // namespace tactnet
