#pragma once

#include <tactnet/deployment/eight_bit/steps.hpp>
#include <tactnet/quantisation/node_executor.hpp>

#include <algorithm>
#include <cstddef>
#include <ratio>
#include <type_traits>
#include <utility>

// The calibration graph of a network, from the descriptions of its steps.

namespace tactnet { inline namespace TACTNET_ARCH {
namespace detail {

/// Appends steps to a graph.
class graph_builder {
public:
    /// `folded`: how many folded numbers come before the first step.
    graph_builder(shape input, std::size_t folded) : folded_(folded) { net_.add_map(input, 0); }
    [[nodiscard]] calibration_graph& network() { return net_; }

    /// Appends a step that reads a map, and returns the map that it writes: `into`, unless that is none.
    template <class Step>
    [[gnu::cold]] std::size_t append(std::size_t input, std::size_t into = calibration_graph::none) {
        std::size_t output = input;
        step_description<Step>::visit(
            [&]<class... Arguments>(const char*, const char*, const Arguments&... arguments) {
                constexpr bool composed = (is_inner_step<Arguments> || ...);
                if constexpr (!composed && requires { &Step::reference; }) {
                    constexpr bool own_range = requires { Step::ranges; };
                    output = add_operator<Step, own_range>(reference_own_step<Step>, input, into);
                } else {
                    output = add<Step>(input, into, arguments...);
                }
            });
        return output;
    }

private:
    // A step by the arguments of its description.
    template <class Step>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t) {
        static_assert(std::is_same_v<Step, no_step>);
        return input;
    }
    template <class Step, class... Steps>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into,
                                  const inner_step<Steps, step_composition::chain>&...) {
        std::size_t left = sizeof...(Steps);
        ((input = append<Steps>(input, --left == 0 ? into : calibration_graph::none)), ...);
        return input;
    }
    /// The skip comes first when it runs, and last among folded numbers and ranges.
    template <class Step, class Main, class Skip>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into,
                                  const inner_step<Main, step_composition::sum>&,
                                  const inner_step<Skip, step_composition::sum>&, input_stride_argument) {
        const std::size_t first = net_.nodes.size();
        const std::size_t output = append<Main>(input, into), sum = net_.nodes.size() - 1;
        net_.nodes[sum].added = append<Skip>(input);
        const auto begin = net_.nodes.begin();
        std::rotate(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(sum + 1),
                    net_.nodes.end());
        return output;
    }
    /// The factors of a gate, and the product.
    template <class Step, class Branch, class Product>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into,
                                  const inner_step<Branch, step_composition::product>&,
                                  const inner_step<Product, step_composition::product>&) {
        const std::size_t factors = append<Branch>(input);
        return add_parameters<Product>({.multiplies = true, .input = input, .added = factors}, into);
    }
    /// Branches that write their slices of one map share its range: the range that the last of them has made.
    template <class Step, class Format, class... Steps>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t, std::type_identity<Format>, const shape&,
                                  input_stride_argument, std::size_t,
                                  const inner_step<Steps, step_composition::concatenation>&...) {
        static_assert(
            (!Steps::fills_map && ...),
            "deploy: in 8 bits each branch of a concatenation must end in a convolution whose filters "
            "fit their place in the common map");
        const std::size_t common = net_.add_map(Step::output, 0);
        (append<Steps>(input, common), ...);
        net_.maps[common].range = net_.ranges - 1;
        return common;
    }
    template <class Step, class Inner>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into,
                                  const inner_step<Inner, step_composition::wrapper>&) {
        net_.softmax = reference_softmax;
        return append<Inner>(input, into);
    }
    template <class Step, class Format>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into, std::type_identity<Format>,
                                  const kernels::frame_convolution& kernel) {
        // All members are named, so that a new one does not compile before it is copied or left out here.
        // Maps of the graph have no gaps, so strides are left out; the map after a pool has the size of the
        // pool.
        const auto& [window, filters, input_stride, pool, pooled_rows, pooled_columns, activation,
                     accumulates, groups, map_stride, map_offset, map_offset_multiple,
                     input_offset_multiple] = kernel;
        return add_parameters<Step>({.window = window,
                                     .groups = groups,
                                     .filters = filters,
                                     .pool = pool,
                                     .relu = activation->rectifies,
                                     .accumulates = accumulates,
                                     .input = input,
                                     .first = map_offset},
                                    into);
    }
    template <class Step, class Format>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into, std::type_identity<Format>,
                                  const kernels::frame_dense& kernel) {
        const auto& [map, input_stride, outputs] = kernel; // all, likewise
        return add_parameters<Step>(
            {.window = {map, {map.rows, map.columns}, 1}, .filters = outputs, .input = input}, into);
    }
    /// A batch norm.
    template <class Step, class Format>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into, std::type_identity<Format>,
                                  const shape&, input_stride_argument, bool relu) {
        return add_parameters<Step>({.reference = reference_norm, .relu = relu, .input = input}, into);
    }
    /// A square root.
    template <class Step, class Format, std::intmax_t Numerator, std::intmax_t Denominator>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into, std::type_identity<Format>,
                                  const shape&, input_stride_argument,
                                  std::type_identity<std::ratio<Numerator, Denominator>>) {
        return add_parameters<Step>(
            {.reference = reference_square_root, .offset = Step::offset, .input = input}, into);
    }
    /// An average pool.
    template <class Step, class Format>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into, std::type_identity<Format>,
                                  const pooling_windows& windows, std::size_t, input_stride_argument) {
        return add_parameters<Step>({.reference = reference_average_pool, .means = windows, .input = input},
                                    into);
    }
    /// A max pool, whose bytes stay what they are.
    template <class Step, class Format>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t, std::type_identity<Format>,
                                  const sliding_window& window, input_stride_argument) {
        return add_node<Step>({.reference = reference_max_pool, .window = window, .input = input},
                              net_.add_map(Step::output, net_.maps[input].range));
    }
    template <class Step, class Format, activation_function Function>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into, std::type_identity<Format>,
                                  std::type_identity<Function>, const shape&, input_stride_argument) {
        return add_operator<Step, (Step::ranges > 1)>(reference_activation<Function>, input, into);
    }

    /// A step whose output has a range of its own, or the range of its input.
    template <class Step, bool OwnRange>
    [[gnu::cold]] std::size_t add_operator(graph_node::function reference, std::size_t input,
                                           std::size_t into) {
        if constexpr (OwnRange)
            return add_parameters<Step>({.reference = reference, .input = input}, into);
        else
            return add_node<Step>({.reference = reference, .input = input},
                                  net_.add_map(Step::output, net_.maps[input].range));
    }
    /// A step whose output has a range of its own, or is the output of the network.
    template <class Step>
    [[gnu::cold]] std::size_t add_parameters(const graph_node& step, std::size_t into) {
        std::size_t range = calibration_graph::none;
        if (Step::ranges > (step.reads_added() ? 2 : 1))
            range = net_.ranges++;
        return add_node<Step>(step,
                              into == calibration_graph::none ? net_.add_map(Step::output, range) : into);
    }
    template <class Step>
    [[gnu::cold]] std::size_t add_node(graph_node step, std::size_t output) {
        step.output = output, step.folded = folded_;
        if constexpr (requires { &Step::set_ranges; })
            step.set_ranges = &Step::set_ranges;
        else if constexpr (requires { Step::arrays; })
            step.set_ranges = [](float* to, const step_ranges& values) {
                Step::arrays.write_ranges(to, values);
            };
        push(step, Step::folded_elements);
        return output;
    }
    [[gnu::cold, gnu::noinline]] void push(graph_node& step, std::size_t folded) {
        step.from = net_.maps[step.input].size, step.to = net_.maps[step.output].size;
        folded_ += folded;
        net_.nodes.push_back(step);
    }

    calibration_graph net_;
    std::size_t folded_;
};

} // namespace detail

/// The calibration graph of a deployed_view in 8 bits.
template <class View>
[[nodiscard]] [[gnu::cold]] detail::calibration_graph calibration_graph_of() {
    detail::graph_builder builder(View::input_shape, View::steps_folded);
    builder.append<typename View::steps>(0);
    return std::move(builder.network());
}

}} // namespace tactnet
