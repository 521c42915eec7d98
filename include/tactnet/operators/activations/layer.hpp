#pragma once

#include <tactnet/operators/activations/function.hpp>
#include <tactnet/operators/layer.hpp>

#include <cstddef>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The elementwise layer of an activation function, in place unless its gradient needs the input.
/// `activation_function.hpp` shows how to write one.
template <activation_function Function>
struct activation {
    static constexpr std::string_view name = Function::name;
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        constexpr bool from_output = !detail::needs_input<Function>;
        return {.output = input, .in_place = from_output, .keeps_output = from_output};
    }

    template <class T, shape Input>
    using layer = layer_base<T, Input, activation>;
};

/// Rectified linear unit: max(x, 0). In place.
using relu = activation<relu_function>;

}} // namespace tactnet
