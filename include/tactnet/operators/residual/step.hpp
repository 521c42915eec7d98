#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/kernels/frame/pooling.hpp>
#include <tactnet/lowering/batch_executor.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Adds a map to what the output holds, each number rounded once: the end of a main branch in a stream.
template <class Format, shape Map, std::size_t Stride>
struct sum_step;
template <class Format, shape Map, std::size_t Stride>
struct step_description<sum_step<Format, Map, Stride>> {
    static constexpr const char* header = "tactnet/operators/residual/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::sum_step", "Sum with the other branch", std::type_identity<Format>{}, Map,
           input_stride_argument{});
    }
};
template <shape Map, std::size_t Stride>
struct sum_step<single_precision, Map, Stride> : step_base<single_precision, Map, Stride> {
    static void run(const float*, const float* in, float* out, float*) noexcept {
        if constexpr (Stride % kernels::lanes<float> == 0)
            kernels::add(in, out, out, Map.area() * Stride);
        else
            for (std::size_t e = 0; e < Map.area() * Stride; ++e)
                out[e] = in[e] + out[e];
    }
};

/// main(x) + skip(x), with the activation function after it. The skip is written to the output first, and the
/// main branch's last convolution adds to it. The input has `InputStride` elements from one pixel to the
/// next.
template <class Main, class Skip, std::size_t InputStride>
struct residual_step : step_defaults, detail::joined_state<Main, Skip> {
    using format = typename Main::format;
    using activation = typename format::activation;
    using packed_number = typename format::packed_number;
    static constexpr shape output = Main::output;
    static constexpr std::size_t output_stride = Main::output_stride;
    static constexpr std::size_t folded_elements = Main::folded_elements + Skip::folded_elements,
                                 packed_elements = Main::packed_elements + Skip::packed_elements;
    /// Elements for a skip that is computed in the workspace, since its pixels have another stride than the
    /// output.
    static constexpr std::size_t aside = [] {
        if constexpr (std::is_same_v<Skip, no_step>)
            return std::size_t{0};
        else
            return Skip::output_stride == output_stride
                       ? 0
                       : pad_to_cache_line<activation>(output.area() * Skip::output_stride);
    }();
    static constexpr std::size_t workspace_elements =
        std::max(Main::workspace_elements, aside + Skip::workspace_elements);

    static constexpr bool layerwise = Main::layerwise || Skip::layerwise;
    static constexpr double largest_output = Main::largest_output;

    static constexpr void pack(const float* from, packed_number* to) {
        Main::pack(from, to);
        Skip::pack(from + Main::folded_elements, to + Main::packed_elements);
    }
    static double output_bound(const float* from, double input) {
        const double sum =
            Main::output_bound(from, input) + Skip::output_bound(from + Main::folded_elements, input);
        if constexpr (Main::after_sum->exists)
            return Main::after_sum->output_bound(sum);
        else
            return sum;
    }
    static void visit_inputs(const float* from, double input, const auto& visit) {
        detail::visit_inputs<Main>(from, input, visit);
        detail::visit_inputs<Skip>(from + Main::folded_elements, input, visit);
    }
    static void run(const packed_number* packed_values, const activation* in, activation* out,
                    activation* memory, auto&... states) noexcept {
        leave_skip(packed_values, in, out, memory, states...);
        detail::run_step<0, Main>(packed_values, in, out, memory, states...);
    }
    /// The first half: writes the skip to the output.
    static void leave_skip(const packed_number* packed_values, const activation* in, activation* out,
                           activation* memory, auto&... states) noexcept {
        if constexpr (std::is_same_v<Skip, no_step>) {
            copy_pixels<InputStride>(in, out);
        } else if constexpr (aside == 0) {
            detail::run_step<1, Skip>(packed_values + Main::packed_elements, in, out, memory, states...);
        } else {
            detail::run_step<1, Skip>(packed_values + Main::packed_elements, in, memory, memory + aside,
                                      states...);
            copy_pixels<Skip::output_stride>(memory, out);
        }
    }
    template <class Executor>
        requires(aside == 0)
    static void run_batch(const packed_number* packed_values, const activation* in, std::size_t in_distance,
                          activation* out, activation* memory, const Executor& executor) {
        if constexpr (std::is_same_v<Skip, no_step>)
            executor.for_each_frame([&](std::size_t frame) {
                copy_pixels<InputStride>(in + frame * in_distance,
                                         out + frame * detail::map_distance<residual_step>);
            });
        else
            detail::run_batch<Skip>(packed_values + Main::packed_elements, in, in_distance, out, memory,
                                    executor);
        detail::run_batch<Main>(packed_values, in, in_distance, out, memory, executor);
    }

private:
    template <std::size_t Stride>
    static void copy_pixels(const activation* from, activation* to) {
        if constexpr (Stride == output_stride) {
            std::memcpy(to, from, output.area() * output_stride * sizeof(activation));
        } else {
            for (std::size_t pixel = 0; pixel < output.area(); ++pixel) {
                activation* const end =
                    std::copy_n(from + pixel * Stride, output.channels, to + pixel * output_stride);
                std::fill(end, to + (pixel + 1) * output_stride, activation{});
            }
        }
    }
};

template <class Main, class Skip, std::size_t InputStride>
struct step_description<residual_step<Main, Skip, InputStride>> {
    static constexpr const char* header = "tactnet/operators/residual/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::residual_step", "Both branches of a residual block",
           inner_step<Main, step_composition::sum>{"main"}, inner_step<Skip, step_composition::sum>{"skip"},
           input_stride_argument{});
    }
};

/// A map times a factor for each channel. `run` takes the factors, one pixel of them, in place of memory.
template <class Format, shape Map, std::size_t Stride>
struct product_step;
template <class Format, shape Map, std::size_t Stride>
struct step_description<product_step<Format, Map, Stride>> {
    static constexpr const char* header = "tactnet/operators/residual/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::product_step", "Channels times factors", std::type_identity<Format>{}, Map,
           input_stride_argument{});
    }
};

template <shape Map, std::size_t Stride>
struct product_step<single_precision, Map, Stride> : step_base<single_precision, Map, Stride> {
    static void run(const float*, const float* in, float* out, const float* factors) noexcept {
        using wide = typename decltype(kernels::pixel_vector<float, Stride>())::type;
        using access = kernels::pixel_access<wide>;
        for (std::size_t v = 0; v < Stride; v += sizeof(wide) / sizeof(float)) {
            const wide factor = access::load(factors + v);
            for (std::size_t e = v; e < Map.area() * Stride; e += Stride)
                access::store(out + e, access::load(in + e) * factor);
        }
    }
};

/// x times the factors that a branch gives of x. `Product` is a product_step. A branch of no_step gives x
/// itself, a map of one pixel.
template <class Branch, class Product>
struct gate_step : step_defaults {
    using format = typename Product::format;
    using activation = typename format::activation;
    using packed_number = typename format::packed_number;
    static constexpr shape output = Product::output;
    static constexpr std::size_t output_stride = Product::output_stride;
    static constexpr std::size_t folded_elements = Branch::folded_elements + Product::folded_elements,
                                 packed_elements = Branch::packed_elements + Product::packed_elements;
    static constexpr bool layerwise = Branch::layerwise;
    /// Elements for the factors, with as many lanes as the map has and as the branch writes.
    static constexpr std::size_t aside = [] {
        if constexpr (std::is_same_v<Branch, no_step>)
            return std::size_t{0};
        else
            return pad_to_cache_line<activation>(std::max(Branch::output_stride, output_stride));
    }();
    static constexpr std::size_t workspace_elements = aside + Branch::workspace_elements;

    static constexpr void pack(const float* from, packed_number* to) {
        Branch::pack(from, to);
        Product::pack(from + Branch::folded_elements, to + Branch::packed_elements);
    }
    /// The larger of the bounds of the branch and of the product.
    static double output_bound(const float* from, double input) {
        const double branch = Branch::output_bound(from, input);
        return std::max(branch, input * std::min(branch, Branch::largest_output));
    }
    static void run(const packed_number* packed_values, const activation* in, activation* out,
                    activation* memory) noexcept {
        const activation* factors = in;
        if constexpr (!std::is_same_v<Branch, no_step>) {
            Branch::run(packed_values, in, memory, memory + aside);
            std::fill(memory + output.channels, memory + aside, activation{});
            factors = memory;
        }
        Product::run(packed_values + Branch::packed_elements, in, out, factors);
    }
};

template <class Branch, class Product>
struct step_description<gate_step<Branch, Product>> {
    static constexpr const char* header = "tactnet/operators/residual/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::gate_step", "Channels times the factors of a branch",
           inner_step<Branch, step_composition::product>{"branch"},
           inner_step<Product, step_composition::product>{"product"});
    }
};

}} // namespace tactnet
