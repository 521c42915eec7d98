#pragma once

#include <tactnet/deployment/eight_bit/steps.hpp>
#include <tactnet/quantisation/reference_operators.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

// The description of a network from the types of its steps. Overloads take a step by its base: a dense layer
// is a convolution.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// Appends steps to a description.
class graph_builder {
public:
    /// `folded`: the numbers in front of those of the steps.
    graph_builder(shape input, std::size_t folded) : folded_(folded) { net_.add_map(input, 0); }
    [[nodiscard]] calibration_graph& network() { return net_; }

    /// Appends a step that reads a map, and returns the map that it writes: `into`, if that is one.
    template <class Step>
    std::size_t append(std::size_t input, std::size_t into = calibration_graph::none) {
        if constexpr (!std::is_same_v<Step, no_step>)
            return add(static_cast<const Step*>(nullptr), input, into);
        else
            return input;
    }

private:
    template <class... Steps>
    std::size_t add(const step_chain<Steps...>*, std::size_t input, std::size_t into) {
        std::size_t left = sizeof...(Steps);
        ((input = append<Steps>(input, --left == 0 ? into : calibration_graph::none)), ...);
        return input;
    }
    /// The skip comes first when it runs, and last among folded numbers and ranges.
    template <class Main, class Skip, std::size_t Stride>
    std::size_t add(const residual_step<Main, Skip, Stride>*, std::size_t input, std::size_t into) {
        const std::size_t first = net_.steps.size();
        const std::size_t output = append<Main>(input, into), sum = net_.steps.size() - 1;
        net_.steps[sum].added = append<Skip>(input);
        const auto begin = net_.steps.begin();
        std::rotate(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(sum + 1),
                    net_.steps.end());
        return output;
    }
    /// Branches that write to their places in one map share its range: that which the last of them has made.
    template <class Format, shape Input, std::size_t S, std::size_t T, class... Branches>
    std::size_t add(const concatenation_step<Format, Input, S, T, Branches...>*, std::size_t input,
                    std::size_t) {
        static_assert(
            (!fills_map<typename Branches::step> && ...),
            "deploy: in 8 bits each branch of a concatenation must end in a convolution whose filters "
            "fit their place in the common map");
        const std::size_t common =
            net_.add_map(concatenation_step<Format, Input, S, T, Branches...>::output, 0);
        (append<typename Branches::step>(input, common), ...);
        net_.maps[common].range = net_.ranges - 1;
        return common;
    }
    template <class Input, class Output, kernels::frame_convolution Kernel>
    std::size_t add(const convolution_step<eight_bit_between<Input, Output>, Kernel>*, std::size_t input,
                    std::size_t into) {
        using step = convolution_step<eight_bit_between<Input, Output>, Kernel>;
        return add_parameters<step>({.window = Kernel.window,
                                     .groups = Kernel.groups,
                                     .filters = Kernel.filters,
                                     .pool = Kernel.pool,
                                     .rectified = Kernel.rectified,
                                     .adds = Kernel.adds,
                                     .input = input,
                                     .first = Kernel.map_offset},
                                    into);
    }
    template <class Input, shape Map, std::size_t Stride, bool Rectified>
    std::size_t add(const norm_step<eight_bit_between<Input, std::uint8_t>, Map, Stride, Rectified>*,
                    std::size_t input, std::size_t into) {
        using step = norm_step<eight_bit_between<Input, std::uint8_t>, Map, Stride, Rectified>;
        return add_parameters<step>({.reference = reference_norm, .rectified = Rectified, .input = input},
                                    into);
    }
    template <class Input, shape Map, std::size_t Stride, class Offset>
    std::size_t add(const square_root_step<eight_bit_between<Input, std::uint8_t>, Map, Stride, Offset>*,
                    std::size_t input, std::size_t into) {
        using step = square_root_step<eight_bit_between<Input, std::uint8_t>, Map, Stride, Offset>;
        return add_parameters<step>(
            {.reference = reference_square_root, .offset = step::offset, .input = input}, into);
    }
    template <class Output, average_windows Windows, std::size_t Channels, std::size_t Stride>
    std::size_t
    add(const average_pool_step<eight_bit_between<std::uint8_t, Output>, Windows, Channels, Stride>*,
        std::size_t input, std::size_t into) {
        using step = average_pool_step<eight_bit_between<std::uint8_t, Output>, Windows, Channels, Stride>;
        return add_parameters<step>({.reference = reference_average_pool, .means = Windows, .input = input},
                                    into);
    }
    /// A step that says `reference` itself.
    template <class Step>
        requires requires {
            &Step::reference;
        }
    std::size_t add(const Step*, std::size_t input, std::size_t into) {
        const graph_node step{.reference = reference_own_step<Step>, .input = input};
        if constexpr (requires { Step::ranges; })
            return add_parameters<Step>(step, into);
        else
            return add_step<Step>(step, net_.add_map(Step::output, net_.maps[input].range));
    }
    template <class Step>
    std::size_t add(const step_with_softmax<Step>*, std::size_t input, std::size_t into) {
        net_.softmax = reference_softmax;
        return append<Step>(input, into);
    }
    /// Bytes stay what they are.
    template <sliding_window Window, std::size_t Stride>
    std::size_t add(const pool_step<eight_bit, Window, Stride>*, std::size_t input, std::size_t) {
        using step = pool_step<eight_bit, Window, Stride>;
        return add_step<step>({.reference = reference_max_pool, .window = Window, .input = input},
                              net_.add_map(step::output, net_.maps[input].range));
    }
    template <shape Map, std::size_t Stride>
    std::size_t add(const relu_step<eight_bit, Map, Stride>*, std::size_t input, std::size_t) {
        using step = relu_step<eight_bit, Map, Stride>;
        return add_step<step>({.reference = reference_relu, .input = input},
                              net_.add_map(Map, net_.maps[input].range));
    }

    /// One whose output has a range of its own, or is the network's.
    template <class Step>
    std::size_t add_parameters(const graph_node& step, std::size_t into) {
        std::size_t range = calibration_graph::none;
        if (Step::ranges > (step.adds ? 2 : 1))
            range = net_.ranges++;
        return add_step<Step>(step,
                              into == calibration_graph::none ? net_.add_map(Step::output, range) : into);
    }
    template <class Step>
    std::size_t add_step(graph_node step, std::size_t output) {
        step.output = output, step.folded = folded_;
        if constexpr (Step::folded > 0)
            step.set_ranges = &Step::set_ranges;
        push(step, Step::folded);
        return output;
    }
    [[gnu::cold, gnu::noinline]] void push(graph_node& step, std::size_t folded) {
        step.from = net_.maps[step.input].size, step.to = net_.maps[step.output].size;
        folded_ += folded;
        net_.steps.push_back(step);
    }

    calibration_graph net_;
    std::size_t folded_;
};

} // namespace detail

/// Of a deployed_view in 8 bits.
template <class View>
[[nodiscard]] [[gnu::cold]] detail::calibration_graph calibration_graph_of() {
    detail::graph_builder description(View::input_shape, View::steps_folded);
    description.append<typename View::steps>(0);
    return std::move(description.network());
}

} // namespace TACTNET_ARCH
} // namespace tactnet
