#pragma once

#include <tactnet/kernels/frame/elementwise.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/operators/activations/function.hpp>

#include <algorithm>
#include <cstddef>
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
        if constexpr (detail::takes_vectors<Function>)
            kernels::transform_map<Map.area() * Stride>([](auto x) { return Function::value(x); }, in, out);
        else
            for (std::size_t e = 0; e < Map.area() * Stride; ++e)
                out[e] = Function::value(in[e]);
        if constexpr (detail::moves_zero<Function> && Map.channels < Stride)
            for (std::size_t pixel = 0; pixel < Map.area() * Stride; pixel += Stride)
                std::fill(out + pixel + Map.channels, out + pixel + Stride, 0.0f);
    }
};

}} // namespace tactnet
