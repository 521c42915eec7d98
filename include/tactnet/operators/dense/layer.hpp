#pragma once

#include <tactnet/operators/layer.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <std::size_t Outputs>
[[nodiscard]] constexpr shape dense_output() {
    static_assert(Outputs > 0, "dense: there must be at least one output");
    return {1, 1, Outputs};
}

} // namespace detail

/// Fully connected layer with bias. Weights are [output][channel][row][column]: PyTorch's order after a
/// flatten.
template <std::size_t Outputs>
struct dense {
    static constexpr std::string_view name = "fc";
    static constexpr bool numbered = false;

    static constexpr layer_costs costs(const shape& input) {
        const std::size_t weights = Outputs * input.size();
        return {.output = {1, 1, Outputs},
                .parameters = weights + Outputs,
                .multiply_adds = weights,
                .multiply_adds_on_pixels = weights};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, dense> {
        static constexpr shape output = detail::dense_output<Outputs>();
        static constexpr std::size_t inputs = Input.size(), weights = Outputs * inputs;

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "weight", parameter_role::weight, {Outputs, inputs}, 0, inputs,
                           Input);
            describe_array(list, prefix, "bias", parameter_role::bias, {Outputs}, weights);
        }
    };
};

}} // namespace tactnet
