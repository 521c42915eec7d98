#pragma once

#include <tactnet/kernels/frame/pooling.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/operators/residual/step.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A map times a factor for each channel. `run` takes the factors, one pixel of them, in place of memory.
template <class Format, shape Map, std::size_t Stride>
struct product_step;
template <class Format, shape Map, std::size_t Stride>
struct step_description<product_step<Format, Map, Stride>> {
    static constexpr const char* header = "tactnet/operators/gate/step.hpp";
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
    static constexpr const char* header = "tactnet/operators/gate/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::gate_step", "Channels times the factors of a branch",
           inner_step<Branch, step_composition::product>{"branch"},
           inner_step<Product, step_composition::product>{"product"});
    }
};

}} // namespace tactnet
