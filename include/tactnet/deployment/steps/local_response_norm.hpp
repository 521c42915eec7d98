#pragma once

#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/frame/local_response.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Local response normalisation. `Rule` is a kernels::response_rule.
template <class Format, shape Map, std::size_t Stride, class Rule>
struct local_response_norm_step;

template <shape Map, std::size_t Stride, class Rule>
struct local_response_norm_step<single_precision, Map, Stride, Rule>
    : step_without_parameters<single_precision, Map, Stride> {
    /// Squares must stay finite, and so must x · k^−β.
    static double output_bound(const float*, double input) {
        return std::max(
            {input, input * std::pow(Rule::k, -Rule::beta), static_cast<double>(Rule::size) * input * input});
    }
    static void run(const float*, const float* in, float* out, float*) noexcept {
        kernels::normalise_pixels<Rule, Stride>(Map.area(), in, out);
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
