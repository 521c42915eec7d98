#pragma once

#include <tactnet/deployment/eight_bit/steps.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/operators/reference.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

// A network in 8 bits as a graph of numbers, so that calibration is compiled once for all networks.
// graph_of.hpp makes the graph of a network's type.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// A feature map, pixel by pixel without gaps.
struct feature_map {
    shape size;
    std::size_t range; ///< the index of the range of its bytes
    std::size_t begin; ///< its first number among the numbers of all maps
};

/// One step: a convolution or a dense layer, whose weights calibration rounds, or a function.
struct graph_node {
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
    /// The step in single precision, with its folded numbers: writes `out`, which may be `in`.
    using function = void (*)(const float* folded, const float* in, const float* added, float* out);

    const kernels::frame_convolution* convolution = nullptr; ///< null for a function
    double largest_input = 0;                                ///< of a convolution, in steps of its input
    function reference = nullptr;
    std::size_t input = 0, added = none, output = 0; ///< maps; it need not read `added`
    std::size_t folded = 0;                          ///< the first of its folded numbers
    /// Writes ranges to its folded numbers; null where it has none.
    void (*set_ranges)(float* folded, const step_ranges& ranges) = nullptr;
};

/// Maps and steps in the order of execution. Map 0 and range 0 belong to the frame. The outputs, which are
/// not bytes, have the range `none`.
struct calibration_graph {
    static constexpr std::size_t none = graph_node::none;
    std::vector<feature_map> maps;
    std::vector<graph_node> nodes;
    std::size_t ranges = 1; ///< how many there are
    /// Those that steps give themselves.
    std::vector<std::pair<std::size_t, map_range>> given{};
    std::size_t numbers = 0; ///< of all maps

    /// Appends a map and returns its index.
    [[gnu::cold]] std::size_t add_map(shape size, std::size_t range) {
        maps.push_back({size, range, numbers});
        numbers += size.size();
        return maps.size() - 1;
    }
    /// A map among the numbers of all maps; null for none.
    template <class T>
    [[nodiscard]] T* map(T* numbers_of_maps, std::size_t which) const {
        return which == none ? nullptr : numbers_of_maps + maps[which].begin;
    }
    /// Whether any map has this range.
    [[nodiscard]] bool has(std::size_t range) const {
        for (const feature_map& map : maps)
            if (map.range == range)
                return true;
        return false;
    }
    /// The range of a map, or (1, 0) if it has none.
    [[nodiscard]] map_range range_of(std::size_t map, std::span<const map_range> of_maps) const {
        if (map == none || maps[map].range == none)
            return {};
        for (const auto& [range, value] : given)
            if (range == maps[map].range)
                return value;
        return of_maps[maps[map].range];
    }
    /// The index of each range that calibration finds, and the index of its step in the order of folded
    /// numbers.
    [[nodiscard]] [[gnu::cold]] std::vector<std::pair<std::size_t, std::size_t>> observed_ranges() const {
        std::vector<std::pair<std::size_t, std::size_t>> found;
        for (const graph_node& node : nodes) {
            const std::size_t range = maps[node.output].range;
            const auto before = [&](const graph_node& other) { return other.folded < node.folded; };
            const auto is_range = [&](const auto& one) { return one.first == range; };
            if (range != none && range != maps[node.input].range &&
                std::none_of(given.begin(), given.end(), is_range))
                found.emplace_back(range, std::count_if(nodes.begin(), nodes.end(), before));
        }
        return found;
    }
    /// The ranges of the maps of a step.
    [[nodiscard]] step_ranges ranges_of(const graph_node& step, std::span<const map_range> of_maps) const {
        return {range_of(step.input, of_maps), range_of(step.added, of_maps), range_of(step.output, of_maps)};
    }
    /// Writes ranges, and the scales of weights that follow from them, to the folded numbers of all steps.
    [[gnu::cold]] void set_ranges(float* folded, std::span<const map_range> of_maps) const {
        for (const graph_node& step : nodes)
            if (step.set_ranges != nullptr)
                step.set_ranges(folded + step.folded, ranges_of(step, of_maps));
    }
};

}}} // namespace tactnet::detail

// The calibration graph of a network, from the descriptions of its steps: how steps are composed is known
// here, what a step computes is known to the step.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Appends steps to a graph.
class graph_builder {
    static constexpr std::size_t none = calibration_graph::none;

public:
    /// `folded`: how many folded numbers come before the first step.
    graph_builder(shape input, std::size_t folded) : folded_(folded) { net_.add_map(input, 0); }
    [[nodiscard]] calibration_graph& network() { return net_; }

    /// Appends a step that reads a map, and returns the map that it writes: `into`, unless that is none.
    template <class Step>
    [[gnu::cold]] std::size_t append(std::size_t input, std::size_t into = none) {
        if constexpr (!std::is_same_v<Step, no_step>)
            step_description<Step>::visit(
                [&]<class... Arguments>(const char*, const char*, const Arguments&... arguments) {
                    if constexpr ((is_inner_step<Arguments> || ...))
                        input = add<Step>(input, into, arguments...);
                    else
                        input = add<Step>(input, into);
                });
        return input;
    }

private:
    template <class, class... Steps>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into,
                                  const inner_step<Steps, step_composition::chain>&...) {
        std::size_t left = sizeof...(Steps);
        ((input = append<Steps>(input, --left == 0 ? into : none)), ...);
        return input;
    }
    /// The skip comes first when it runs, and last among folded numbers and ranges.
    template <class, class Main, class Skip>
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
    template <class, class Branch, class Product>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into,
                                  const inner_step<Branch, step_composition::product>&,
                                  const inner_step<Product, step_composition::product>&) {
        const std::size_t factors = append<Branch>(input), output = append<Product>(input, into);
        net_.nodes.back().added = factors;
        return output;
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
    /// What a wrapper does to the outputs of the step inside.
    template <class Step, class Inner>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into,
                                  const inner_step<Inner, step_composition::wrapper>&) {
        const std::size_t output = append<Inner>(input, into);
        net_.nodes.push_back({.reference = reference_of<Step>(), .input = output, .output = output});
        return output;
    }
    /// Any other step. A map of bytes has a range of its own if the step lists one, otherwise that of the
    /// input, since its bytes stay what they are.
    template <class Step>
    [[gnu::cold]] std::size_t add(std::size_t input, std::size_t into) {
        graph_node step{.largest_input = Step::largest_input, .input = input, .folded = folded_};
        std::size_t range = Step::number_elements == 1 ? net_.maps[input].range : none;
        if constexpr (requires { Step::output_range; })
            range = net_.ranges++, net_.given.emplace_back(range, Step::output_range);
        else if constexpr (requires { Step::arrays; })
            if (Step::arrays.has_output_range())
                range = net_.ranges++;
        if constexpr (Step::folded_elements > 0)
            step.set_ranges = &write_ranges<Step>;
        if constexpr (requires { Step::kernel; })
            step.convolution = &Step::kernel;
        else if constexpr (!has_state<Step>) // stream_observer runs those
            step.reference = reference_of<Step>();
        step.output = into == none ? net_.add_map(Step::output, range) : into;
        push(step, Step::folded_elements);
        return step.output;
    }
    template <class Step>
    [[nodiscard]] static graph_node::function reference_of() {
        if constexpr (requires(const float* in, float* out) { Step::reference(in, in, out); })
            return [](const float* folded, const float* in, const float*, float* out) {
                Step::reference(folded, in, out);
            };
        else if constexpr (requires(const float* in, float* out) { Step::reference(in, in, in, out); })
            return &Step::reference;
        else
            static_assert(Step::output.size() == 0,
                          "deploy: in 8 bits each step needs a function `reference` for calibration");
    }
    [[gnu::cold, gnu::noinline]] void push(const graph_node& step, std::size_t folded) {
        folded_ += folded;
        net_.nodes.push_back(step);
    }

    calibration_graph net_;
    std::size_t folded_;
};

} // namespace detail

/// The calibration graph of a deployed_view or a stream_view in 8 bits.
template <class View>
[[nodiscard]] [[gnu::cold]] detail::calibration_graph calibration_graph_of() {
    detail::graph_builder builder(View::input_shape, View::steps_folded);
    builder.append<typename View::steps>(0);
    return std::move(builder.network());
}

}} // namespace tactnet
