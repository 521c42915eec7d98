#pragma once

#include <tactnet/kernels/frame/elementwise.hpp>
#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/operators/activations/function.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// An elementwise activation that no convolution or batch norm has fused.
template <class Format, class Function, shape Map, std::size_t Stride>
struct activation_step;
template <class Format, class Function, shape Map, std::size_t Stride>
struct step_description<activation_step<Format, Function, Map, Stride>> {
    static constexpr const char* header = "tactnet/operators/activations/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::activation_step", Function::title, std::type_identity<Format>{},
           std::type_identity<Function>{}, Map, input_stride_argument{});
    }
};

template <class Function, shape Map, std::size_t Stride>
struct activation_step<single_precision, Function, Map, Stride> : step_base<single_precision, Map, Stride> {
    static constexpr double largest_output = detail::largest_value<Function>();
    static double output_bound(const float*, double input) {
        return detail::activation_bound<Function>(input);
    }
    static void run(const float*, const float* in, float* out, float*) noexcept {
        if constexpr (detail::works_on_vectors<Function>)
            kernels::transform_map<Map.area() * Stride>([](auto x) { return Function::value(x); }, in, out);
        else
            for (std::size_t e = 0; e < Map.area() * Stride; ++e)
                out[e] = Function::value(in[e]);
        if constexpr (detail::moves_zero<Function> && Map.channels < Stride)
            for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride)
                std::fill(out + pixel + Map.channels, out + pixel + Stride, 0.0f);
    }
};

/// A parametric ReLU: x above 0, otherwise x times the slope of its channel. The slopes are its numbers.
template <class Format, shape Map, std::size_t Stride>
struct parametric_relu_step;
template <class Format, shape Map, std::size_t Stride>
struct step_description<parametric_relu_step<Format, Map, Stride>> {
    static constexpr const char* header = "tactnet/operators/activations/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::parametric_relu_step", "Parametric ReLU", std::type_identity<Format>{}, Map,
           input_stride_argument{});
    }
};

template <shape Map, std::size_t Stride>
struct parametric_relu_step<single_precision, Map, Stride> : step_base<single_precision, Map, Stride> {
    static constexpr std::size_t folded_elements = Map.channels, packed_elements = pad_to_cache_line(Stride);

    static constexpr void pack(const float* from, float* to) { std::copy_n(from, Map.channels, to); }
    static double output_bound(const float* from, double input) {
        double most = 1;
        for (std::size_t c = 0; c < Map.channels; ++c)
            most = std::max(most, std::abs(static_cast<double>(from[c])));
        return most * input;
    }
    static void run(const float* slopes, const float* in, float* out, float*) noexcept {
        kernels::scale_negative<Stride>(Map.area(), slopes, in, out);
    }
};

/// √(x + offset) − √offset, and 0 for x below 0. `Offset` is a std::ratio.
template <class Format, shape Map, std::size_t Stride, class Offset>
struct square_root_step;
template <class Format, shape Map, std::size_t Stride, class Offset>
struct step_description<square_root_step<Format, Map, Stride, Offset>> {
    static constexpr const char* header = "tactnet/operators/activations/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::square_root_step", "Square root", std::type_identity<Format>{}, Map,
           input_stride_argument{}, std::type_identity<Offset>{});
    }
};

template <shape Map, std::size_t Stride, class Offset>
struct square_root_step<single_precision, Map, Stride, Offset> : step_base<single_precision, Map, Stride> {
    static constexpr double offset = static_cast<double>(Offset::num) / static_cast<double>(Offset::den);

    /// x + offset must stay finite too, and roots of small numbers exceed the numbers.
    static double output_bound(const float*, double input) { return std::max(input, 1.0) + offset; }
    static void run(const float*, const float* in, float* out, float*) noexcept {
        kernels::transform_map<Map.area() * Stride>(kernels::shifted_root(static_cast<float>(offset)), in,
                                                    out);
    }
};

/// Softmax over the channels of each pixel.
template <class Format, shape Map, std::size_t Stride>
struct softmax_step;
template <class Format, shape Map, std::size_t Stride>
struct step_description<softmax_step<Format, Map, Stride>> {
    static constexpr const char* header = "tactnet/operators/activations/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::softmax_step", "Softmax", std::type_identity<Format>{}, Map, input_stride_argument{});
    }
};

template <shape Map, std::size_t Stride>
struct softmax_step<single_precision, Map, Stride> : step_base<single_precision, Map, Stride> {
    static constexpr bool gives_probabilities = true;

    static void run(const float*, const float* in, float* out, float*) noexcept {
        for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride) {
            kernels::softmax_of<float>(std::span(in + pixel, Map.channels),
                                       std::span(out + pixel, Map.channels));
            std::fill(out + pixel + Map.channels, out + pixel + Stride, 0.0f);
        }
    }
};

/// A step that writes the outputs of a network as floats, with the softmax of these outputs in their place:
/// for number formats whose maps hold something else.
template <class Step>
struct step_with_softmax : Step {
    using activation = typename Step::format::activation;
    static constexpr bool gives_probabilities = true;

    static void run(const typename Step::format::packed_number* packed, const activation* in, activation* out,
                    activation* memory) noexcept {
        Step::run(packed, in, out, memory);
        apply<Step::output_stride>(reinterpret_cast<float*>(out));
    }
    /// For calibration, from outputs to probabilities in their place.
    static void reference(const float*, const float*, float* out) { apply<Step::output.channels>(out); }

private:
    template <std::size_t Stride>
    static void apply(float* outputs) {
        for (std::size_t pixel = 0; pixel < Step::output.area() * Stride; pixel += Stride)
            kernels::softmax_of<float>(std::span<const float>(outputs + pixel, Step::output.channels),
                                       std::span(outputs + pixel, Step::output.channels));
    }
};
template <class Step>
struct step_description<step_with_softmax<Step>> {
    static constexpr const char* header = "tactnet/operators/activations/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::step_with_softmax", "Softmax of the outputs",
           inner_step<Step, step_composition::wrapper>{""});
    }
};
/// The step for a softmax in the middle of a network, which such a format cannot compute.
template <class Step>
struct softmax_not_last : Step {
    using activation = typename Step::format::activation;

    static void run(const typename Step::format::packed_number*, const activation*, activation*,
                    activation*) noexcept {
        static_assert(Step::output.size() == 0, "deploy: in this number format a softmax must be the last "
                                                "layer: maps in front of others hold no probabilities");
    }
};

}} // namespace tactnet
