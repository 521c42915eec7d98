#pragma once

#include <tactnet/kernels/frame/elementwise.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A parametric ReLU: x above 0, otherwise x times the slope of its channel. The slopes are its numbers.
template <class Format, shape Map, std::size_t Stride>
struct parametric_relu_step;
template <class Format, shape Map, std::size_t Stride>
struct step_description<parametric_relu_step<Format, Map, Stride>> {
    static constexpr const char* header = "tactnet/operators/parametric_relu/step.hpp";
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

}} // namespace tactnet
