#pragma once

#include <tactnet/kernels/frame/elementwise.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Local response normalisation. `Rule` is a kernels::response_rule.
template <class Format, shape Map, std::size_t Stride, class Rule>
struct local_response_norm_step;
template <class Format, shape Map, std::size_t Stride, class Rule>
struct step_description<local_response_norm_step<Format, Map, Stride, Rule>> {
    static constexpr const char* header = "tactnet/operators/local_response_norm/step.hpp";
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
